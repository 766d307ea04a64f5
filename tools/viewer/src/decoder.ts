// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's stream reader (decoder/decoder.cc), one a WebAssembly instance: bytes in as they come, a valid TIN at any time.
import type { MapPosition } from './answers';
import { type DecodeError, type GroundFacts, type ModuleExports, decodeErrorOf, describeGround, instanceOf, numbersAt } from './module';

/** Facts of the terrain. Positions in the mesh are on a grid: map = origin + step * grid. */
export interface Facts {
  originX: number; originY: number; stepX: number; stepY: number;
  heightIsFloat: boolean; heightStep: number; heightOffset: number;
  /** Of the whole terrain, on the grid. */
  minX: number; minY: number; maxX: number; maxY: number;
  /** Of all samples; min > max when all is void. */
  minHeight: number; maxHeight: number;
  baseError: number; baseDeviation: number;
}

export interface Certificate {
  /** At every sample. */
  error: number;
  /** At any point. */
  deviation: number;
}

/** Words of a vertex: x, y on the grid, bits of the height, a triangle. */
export const vertexWords = 4;
/** Words of a triangle: its corners, counter-clockwise, then across from each its neighbour, or `none`. */
export const triangleWords = 6;
export const none = 0xffffffff;

/** The mesh where it lies in the decoder's memory: valid until the decoder is fed again. */
export interface MeshView {
  vertexCount: number;
  triangleCount: number;
  /** `vertexWords` a vertex; positions are signed. */
  vertices: Int32Array;
  hasHeight: Uint8Array;
  /** `triangleWords` a triangle. */
  triangles: Uint32Array;
  /** 1: void. */
  classes: Uint8Array;
}

interface Exports extends ModuleExports {
  room(bytes: number): number;
  feed(bytes: number, oneFrame: number): number;
  beginNext(): void;
  hasMesh(): number;
  isComplete(): number;
  numbering(): number;
  splits(): number;
  splitsInAll(): number;
  bytesUsed(): number;
  certifiedError(): number;
  certifiedDeviation(): number;
  vertexCount(): number;
  vertices(): number;
  hasHeight(): number;
  triangleCount(): number;
  triangles(): number;
  classes(): number;
  facts(): number;
  metadata(): number;
  metadataBytes(): number;
  metresBetween(ax: number, ay: number, bx: number, by: number): number;
  metresPerMapUnit(x: number, y: number): number;
  reliefError(): number;
  reliefDeviation(): number;
}

/** Numbers of PlainFacts (decoder/module.h). */
export const factNumbers = 15;

let versions = 0;

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

  /** Gives up the rest of a stream that was cut: the bytes fed next are those of another one. */
  beginNext(): void {
    this.version = ++versions;
    this.wasm.beginNext();
  }

  get hasMesh(): boolean { return this.wasm.hasMesh() !== 0; }
  get isComplete(): boolean { return this.wasm.isComplete() !== 0; }
  /** Changes when vertices and triangles get other numbers. */
  get numbering(): number { return this.wasm.numbering(); }
  get splits(): number { return this.wasm.splits(); }
  get splitsInAll(): number { return this.wasm.splitsInAll(); }
  get bytesUsed(): number { return this.wasm.bytesUsed(); }
  get certificate(): Certificate {
    return { error: this.wasm.certifiedError(), deviation: this.wasm.certifiedDeviation() };
  }
  /** Bytes of memory that the decoder holds. */
  get memoryBytes(): number { return this.wasm.memory.buffer.byteLength; }

  /** The facts as both modules have them, in the order of PlainFacts. */
  get plainFacts(): Float64Array { return numbersAt(this.wasm.memory, this.wasm.facts(), factNumbers); }

  get facts(): Facts {
    const f = this.plainFacts;
    return {
      originX: f[0], originY: f[1], stepX: f[2], stepY: f[3], heightIsFloat: f[4] !== 0, heightStep: f[5],
      heightOffset: f[6], minX: f[7], minY: f[8], maxX: f[9], maxY: f[10], minHeight: f[11], maxHeight: f[12],
      baseError: f[13], baseDeviation: f[14],
    };
  }

  /** JSON of the sender: CRS, units, what was asked. */
  get metadata(): string {
    const bytes = new Uint8Array(this.wasm.memory.buffer, this.wasm.metadata(), this.wasm.metadataBytes());
    return new TextDecoder().decode(bytes);
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

  /** What holds of any mesh of this terrain: both lie between its least and its greatest height. */
  get certificateByRelief(): Certificate {
    return { error: this.wasm.reliefError(), deviation: this.wasm.reliefDeviation() };
  }

  get mesh(): MeshView {
    const { wasm } = this;
    const buffer = wasm.memory.buffer;
    const vertexCount = wasm.vertexCount();
    const triangleCount = wasm.triangleCount();
    return {
      vertexCount,
      triangleCount,
      vertices: new Int32Array(buffer, wasm.vertices(), vertexCount * vertexWords),
      hasHeight: new Uint8Array(buffer, wasm.hasHeight(), vertexCount),
      triangles: new Uint32Array(buffer, wasm.triangles(), triangleCount * triangleWords),
      classes: new Uint8Array(buffer, wasm.classes(), triangleCount),
    };
  }
}
