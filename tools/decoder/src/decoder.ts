// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's stream reader (wasm/decoder.cc), one a WebAssembly instance: bytes in as they come, a valid TIN at any time.
import { type Certificate, type Facts, factNames } from './facts.js';
import type { MapPosition } from './map_window.js';
import { type MeshExports, type MeshView, meshIn } from './mesh.js';
import { type DecodeError, type GroundFacts, decodeErrorOf, describeGround, instanceOf, numbersAt } from './module.js';

interface Exports extends MeshExports {
  room(bytes: number): number;
  feed(bytes: number, oneFrame: number): number;
  beginNext(): void;
  hasMesh(): number;
  isComplete(): number;
  numbering(): number;
  splits(): number;
  splitsInAll(): number;
  certifiedError(): number;
  certifiedDeviation(): number;
  facts(): number;
  metadata(): number;
  metadataBytes(): number;
  metresBetween(ax: number, ay: number, bx: number, by: number): number;
  metresPerMapUnit(x: number, y: number): number;
  curvature(): number;
  lightSpeed(): number;
}

let versions = 0;

/** One stream, and those that go on from it. It holds memory of its own, some 60 bytes a vertex, until nobody refers to it. */
export class Decoder {
  private readonly wasm: Exports;
  private failure: DecodeError | null = null;
  /** Another number whenever the mesh may have changed; two decoders never have the same. */
  version = ++versions;

  constructor(module: WebAssembly.Module) {
    this.wasm = instanceOf<Exports>(module);
  }

  /**
   * Takes the next bytes, however they were cut, and applies every frame that is whole by now; with `oneFrame` nothing
   * behind the first that `bytes` complete. Returns how many were taken: fewer when a frame or the stream ends before.
   * Throws DecodeError; then nothing more can be fed.
   */
  feed(bytes: Uint8Array, oneFrame = false): number {
    if (this.failure !== null) throw this.failure;
    this.version = ++versions;
    try {
      const room = this.wasm.room(bytes.length);
      new Uint8Array(this.wasm.memory.buffer, room, bytes.length).set(bytes);
      return this.wasm.feed(bytes.length, oneFrame ? 1 : 0);
    } catch (error) {
      this.failure = decodeErrorOf(error);
      throw this.failure;
    }
  }

  /** Gives up the rest of a stream that was cut: the bytes fed next are those of another one. After damage there is no next one. */
  beginNext(): void {
    if (this.failure !== null) return;
    this.version = ++versions;
    this.wasm.beginNext();
  }

  get hasMesh(): boolean { return this.wasm.hasMesh() !== 0; }
  get isComplete(): boolean { return this.wasm.isComplete() !== 0; }
  /** Changes when vertices and triangles get other numbers. */
  get numbering(): number { return this.wasm.numbering(); }
  get splits(): number { return this.wasm.splits(); }
  get splitsInAll(): number { return this.wasm.splitsInAll(); }
  /** The certificate of the stream where it was asked for, which certifiedOf() tells; null before the first mesh. */
  get certificate(): Certificate | null {
    return !this.hasMesh ? null : { error: this.wasm.certifiedError(), deviation: this.wasm.certifiedDeviation() };
  }

  /** True when the next frame may bring more vertices: a sender puts an eighth of the mesh into one, and at least 256. */
  mayExceed(mostVertices: number): boolean {
    const now = this.wasm.vertexCount();
    return now + Math.max(256, now / 8) > mostVertices;
  }

  get facts(): Facts {
    const numbers = numbersAt(this.wasm.memory, this.wasm.facts(), factNames.length);
    return Object.fromEntries(factNames.map((name, i) => [name, numbers[i]])) as Facts;
  }

  /** Metadata of the sender in JSON: CRS, units, what was asked. Text that is no JSON tells nothing: null. */
  get metadata(): unknown {
    const bytes = new Uint8Array(this.wasm.memory.buffer, this.wasm.metadata(), this.wasm.metadataBytes());
    try {
      return JSON.parse(new TextDecoder().decode(bytes));
    } catch {
      return null;
    }
  }

  /** Tells the ground below the terrain, for lengths; without any they are map units. */
  describe(ground: GroundFacts | null): void {
    describeGround(this.wasm, ground);
  }

  /** Over ground; not a number where that is not known. */
  metresBetween(a: MapPosition, b: MapPosition): number {
    return this.wasm.metresBetween(a.x, a.y, b.x, b.y);
  }

  /** Metres over ground of a map unit along x and along y. */
  metresPerMapUnit(at: MapPosition): [number, number] {
    const [x, y] = numbersAt(this.wasm.memory, this.wasm.metresPerMapUnit(at.x, at.y), 2);
    return [x, y];
  }

  /** How much lower what lies at a distance looks, for the square of the distance; in the height's unit. */
  get curvature(): number { return this.wasm.curvature(); }
  /** The height's units a second. */
  get lightSpeed(): number { return this.wasm.lightSpeed(); }

  /** Valid until the decoder is fed again. */
  get mesh(): MeshView { return meshIn(this.wasm); }
}
