// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's stream reader (decoder/decoder.cc), one a WebAssembly instance: bytes in as they come, a valid TIN at any time, and
// the engine's answers about it (decoder/questions.cc).

import { stationsOf } from './answers';
import type { Located, MapPosition, PointState, Profile, Sight, SightPoint } from './answers';
import type { GroundFacts } from './earth';

/** Why a stream was refused: the names of the engine's ErrorCode, in its order. */
export const errorCodes = [
  'invalid_argument', 'not_found', 'corruption', 'unsupported_version', 'io_error', 'resource_exhausted', 'cancelled',
  'internal',
] as const;
export type ErrorCode = (typeof errorCodes)[number];

/** The stream cannot be followed any further. What was decoded before stays readable. */
export class DecodeError extends Error {
  constructor(readonly code: ErrorCode, message: string) {
    super(message);
    this.name = 'DecodeError';
  }
}

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

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
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
  describe(
    geographic: number, semiMajor: number, inverseFlattening: number, radiansPerMapUnit: number, metresPerMapUnit: number,
    metresPerHeight: number, freeOfVoids: number, isWhole: number): void;
  metresBetween(ax: number, ay: number, bx: number, by: number): number;
  metresPerMapUnit(x: number, y: number): number;
  reliefError(): number;
  reliefDeviation(): number;
  locate(x: number, y: number, isCertified: number): number;
  profile(ax: number, ay: number, bx: number, by: number, isCertified: number): number;
  sight(
    ax: number, ay: number, heightA: number, bx: number, by: number, heightB: number, hertz: number, isCertified: number): number;
}

const states: readonly PointState[] = ['surface', 'void', 'outside'];
const verdicts: ReadonlyArray<Sight['verdict']> = ['visible', 'hidden', 'unsure', 'undefined'];
const orNull = (value: number): number | null => (Number.isNaN(value) ? null : value);

export class Decoder {
  private readonly wasm: Exports;
  private failure: DecodeError | null = null;

  constructor(module: WebAssembly.Module) {
    const fail = (code: number, text: number, bytes: number): never => {
      const message = new TextDecoder().decode(new Uint8Array(this.wasm.memory.buffer, text, bytes));
      throw new DecodeError(errorCodes[code] ?? 'internal', message);
    };
    this.wasm = new WebAssembly.Instance(module, { host: { fail } }).exports as unknown as Exports;
    this.wasm._initialize();
  }

  /**
   * Takes the next bytes, however they were cut, and applies every frame that is whole by now; with `oneFrame` nothing
   * behind the first that `bytes` complete. Returns how many were taken: fewer when a frame or the stream ends before.
   * Throws DecodeError; then nothing more can be fed.
   */
  feed(bytes: Uint8Array, oneFrame = false): number {
    if (this.failure !== null) throw this.failure;
    try {
      const room = this.wasm.room(bytes.length);
      new Uint8Array(this.wasm.memory.buffer, room, bytes.length).set(bytes);
      return this.wasm.feed(bytes.length, oneFrame ? 1 : 0);
    } catch (error) {
      this.failure = error instanceof DecodeError
        ? error
        : new DecodeError('resource_exhausted', 'the decoder came to its end: ' + String(error));
      throw this.failure;
    }
  }

  /** Gives up the rest of a stream that was cut: the bytes fed next are those of another one. */
  beginNext(): void {
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

  get facts(): Facts {
    const f = new Float64Array(this.wasm.memory.buffer, this.wasm.facts(), 15);
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

  /** What the metadata tell, for questions. `isWhole`: no record of the file is missing. Without `ground` lengths are map units. */
  describe(ground: GroundFacts | null, freeOfVoids: boolean, isWhole: boolean): void {
    const g = ground;
    this.wasm.describe(
      g?.geographic === true ? 1 : 0, g?.semi_major ?? 6378137, g?.inverse_flattening ?? 0, g?.radians_per_map_unit ?? 0,
      g?.metres_per_map_unit ?? 1, g?.metres_per_height ?? 1, freeOfVoids ? 1 : 0, isWhole ? 1 : 0);
  }

  /** Over ground; not a number where that is not known. */
  metresBetween(a: MapPosition, b: MapPosition): number {
    return this.wasm.metresBetween(a.x, a.y, b.x, b.y);
  }

  /** Metres over ground of a map unit along x and along y. */
  metresPerMapUnit(at: MapPosition): [number, number] {
    const [x, y] = this.numbers(this.wasm.metresPerMapUnit(at.x, at.y), 2);
    return [x, y];
  }

  /** What holds of any mesh of this terrain: both lie between its least and its greatest height. */
  get certificateByRelief(): Certificate {
    return { error: this.wasm.reliefError(), deviation: this.wasm.reliefDeviation() };
  }

  /** What the mesh holds at a place. `isCertified`: the stream's certificate holds there. */
  locate(at: MapPosition, isCertified: boolean): Located {
    const n = this.numbers(this.wasm.locate(at.x, at.y, isCertified ? 1 : 0), 13);
    const state = states[n[0]];
    const triangle = [4, 7, 10].map((i) => ({ x: n[i], y: n[i + 1], height: orNull(n[i + 2]) }));
    return {
      state, height: orNull(n[1]), least: orNull(n[2]), most: orNull(n[3]), triangle: state === 'outside' ? [] : triangle,
    };
  }

  /** The heights along a line over the mesh. */
  profile(a: MapPosition, b: MapPosition, isCertified: boolean): Omit<Profile, 'lengths'> {
    const at = this.wasm.profile(a.x, a.y, b.x, b.y, isCertified ? 1 : 0);
    const [count] = this.numbers(at, 1);
    const n = this.numbers(at + 8, 5 * count);
    const points = Array.from({ length: count }, (_, i) => ({
      distance: n[5 * i], x: n[5 * i + 1], y: n[5 * i + 2], height: orNull(n[5 * i + 3]), state: states[n[5 * i + 4]],
    }));
    return { stations: stationsOf(points), length: points[count - 1].distance };
  }

  /** A line of sight over the mesh: heights above ground, in the height's unit. */
  sight(a: MapPosition, heightA: number, b: MapPosition, heightB: number, hertz: number, isCertified: boolean): Sight {
    const n = this.numbers(this.wasm.sight(a.x, a.y, heightA, b.x, b.y, heightB, hertz, isCertified ? 1 : 0), 17);
    const point = (i: number): SightPoint => ({ x: n[i], y: n[i + 1], distance: n[i + 2], height: n[i + 3] });
    return {
      verdict: verdicts[n[0]], length: n[1],
      clearance: Number.isNaN(n[9]) ? null : { min: n[2], max: n[3], at: point(5) },
      fresnel: Number.isNaN(n[4]) ? null : { ratio: n[4], at: point(13) },
    };
  }

  /** A copy of what an answer holds. */
  private numbers(at: number, count: number): Float64Array {
    return new Float64Array(this.wasm.memory.buffer, at, count).slice();
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
