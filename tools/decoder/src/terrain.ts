// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain that becomes finer while it arrives, whatever it comes from (stream_terrain.ts, served_terrain.ts).
import { type Certified, certifiedWithin } from './certified.js';
import type { Decoder } from './decoder.js';
import { type Certificate, boundsOf, onMap } from './facts.js';
import { type Window, widened } from './map_window.js';
import { type Told, mapCrsOf, toldBy } from './metadata.js';
import { type LocalFrame, localPositions, mapPositions, surfaceCorners } from './surface.js';

/**
 * A certificate of a mesh in all of a window: no sample of the source is farther from it than `error`, and no point of the full terrain
 * than `deviation`, both measured upright.
 */
export interface Certainty extends Certificate {
  /** The unit of both, as `metre` or `US survey foot`; null: the terrain does not tell. */
  unit: string | null;
  /** Where it holds: west, south, east, north in the CRS of the file. */
  window: Window;
}

/**
 * Why a step is what it is. `refining`: more is on its way. `reached`: the error that was asked for is certified. `vertices`,
 * `bytes`: the budget is used up. `complete`: there is no more. `cut`: the bytes ended before the stream did.
 */
export type State = 'refining' | 'reached' | 'vertices' | 'bytes' | 'complete' | 'cut';

/** A mesh at some time. Its arrays are the caller's: nothing writes to them any more, and they may be transferred. */
export interface Mesh<Positions extends Float32Array | Float64Array = Float32Array> {
  /**
   * x, y, z of each vertex. Local: metres east, north and up from `Terrain.frame.origin` (map units where no ground is known).
   * Map: the CRS of the file, z the height. A vertex in a void, which no triangle has, lies at the least height.
   */
  positions: Positions;
  /** Three vertices of each triangle, counter-clockwise seen from above. Where the terrain has no data there are none. */
  indices: Uint32Array;
  /** Null where nothing is known, as beyond the window of a stream, or of a stream for isolines. */
  certified: Certainty | null;
  /** Received of this terrain until then. */
  bytes: number;
}

export interface Step<Positions extends Float32Array | Float64Array = Float32Array> extends Mesh<Positions> {
  state: State;
}

export interface MeshOptions {
  /** The part that `certified` tells of: by default the one that was asked for last. */
  window?: Window;
  /** `local` (Float32Array, as graphics want it; the default), or `map` (Float64Array). */
  positions?: 'local' | 'map';
}

export interface RefineOptions extends MeshOptions {
  /** Stops at this certified error, in the unit of heights; 0 or absent: at full detail. */
  error?: number;
  /** Stops before the mesh has more vertices; a single frame of a stream may go an eighth beyond. */
  maxVertices?: number;
  /** Stops when this call has received so many bytes, at the end of a frame or a piece. */
  maxBytes?: number;
  /**
   * The part that is wanted, in the CRS of the file: west, south, east, north. Of a service only that part is refined; a stream
   * that was written before refines everywhere, and `certified` tells of this part.
   */
  window?: Window;
  /** The mesh has so many times the vertices of the step before: 1.5. At 1 each frame is a step, at Infinity the last alone. */
  growth?: number;
  /** Ends the call with the signal's reason; what came stays, and another call goes on. */
  signal?: AbortSignal;
}

/** Metres in a local frame, or null where map units stand for them. */
export interface Frame extends LocalFrame {
  unit: 'metre' | null;
}

export abstract class Terrain {
  private isRefining = false;
  private described: { told: Told; frame: Frame } | null = null;

  /** The decoder whose mesh this is: for what is not offered here. Valid until more is received. */
  abstract readonly decoder: Decoder;
  /** Received until now. */
  abstract readonly bytes: number;
  protected abstract readonly certified: Certified;
  /** The part that was asked of the sender. */
  protected abstract readonly window: Window;

  /** Applies what arrives, frame by frame; says after each whether more is on its way. */
  protected abstract receive(options: RefineOptions): AsyncGenerator<State, void, void>;
  /** Lets go of connections, unless more is wanted at once. */
  protected abstract rest(): void;

  /** The whole terrain: west, south, east, north in the CRS of the file. */
  get bounds(): Window { return boundsOf(this.decoder.facts); }
  /** The least and the greatest height of the full terrain; null: it has no data at all. */
  get heights(): readonly [least: number, greatest: number] | null {
    const { minHeight, maxHeight } = this.decoder.facts;
    return minHeight <= maxHeight ? [minHeight, maxHeight] : null;
  }
  /** The CRS of the file as WKT; null: not told. */
  get crs(): string | null { return this.told.crs; }
  /** The same without a vertical part: what libraries of maps read. */
  get mapCrs(): string | null { return this.crs === null ? null : mapCrsOf(this.crs); }
  /** Units of the map and of heights; null: not told. */
  get units(): { horizontal: string | null; height: string | null } {
    const { horizontal, height } = this.told.units;
    return { horizontal: named(horizontal), height: named(height) };
  }
  /** The frame of local positions: around the middle of the terrain, the same for all steps. */
  get frame(): Frame { return this.about.frame; }

  /** The mesh of now. Cost: linear. */
  mesh(options: MeshOptions & { positions: 'map' }): Mesh<Float64Array>;
  mesh(options?: MeshOptions): Mesh;
  mesh({ window = this.window, positions = 'local' }: MeshOptions = {}): Mesh | Mesh<Float64Array> {
    const { decoder: { mesh, facts }, frame, bytes } = this;
    const rest = { indices: surfaceCorners(mesh), certified: this.certifiedIn(window), bytes };
    return positions === 'map' ? { positions: mapPositions(mesh, facts), ...rest }
      : { positions: localPositions(mesh, facts, frame), ...rest };
  }

  /**
   * Receives more until the error is certified, the budget is used up or nothing is left, and gives meshes on the way: the first as
   * soon as it grew, the last at the end. While the caller is busy with one nothing is received. Leaving the loop stops receiving; a
   * later call goes on from what is there.
   *
   * Throws DecodeError of what is damaged or no stream, Problem of a host that fails or refuses, and the reason of an aborted
   * signal. What came before stays: `mesh()`.
   */
  refine(options: RefineOptions & { positions: 'map' }): AsyncGenerator<Step<Float64Array>, void, void>;
  refine(options?: RefineOptions): AsyncGenerator<Step, void, void>;
  async *refine(options: RefineOptions = {}): AsyncGenerator<Step | Step<Float64Array>, void, void> {
    if (this.isRefining) throw new Error('this terrain is being refined already: end that loop first');
    this.isRefining = true;
    const { growth = 1.5 } = options;
    try {
      let next = growth === Infinity ? Infinity : 0;
      for await (const state of this.receive(options)) {
        const { vertexCount } = this.decoder.mesh;
        if (state === 'refining' && vertexCount < next) continue;
        next = vertexCount * growth;
        yield { ...this.mesh(options), state };
        options.signal?.throwIfAborted();
      }
    } finally {
      this.isRefining = false;
      this.rest();
    }
  }

  /** The last step of refine(), for who wants no mesh on the way. Throws as it does. */
  refined(options: RefineOptions & { positions: 'map' }): Promise<Step<Float64Array>>;
  refined(options?: RefineOptions): Promise<Step>;
  async refined(options: RefineOptions = {}): Promise<Step | Step<Float64Array>> {
    let last: Step | null = null;
    for await (last of this.refine({ ...options, growth: Infinity }));
    if (last === null) throw new Error('a terrain gave no step');
    return last;
  }

  /** The certificate of all of a window, in the CRS of the file; null where nothing is known of a part of it. */
  certifiedIn(window: Window): Certainty | null {
    // Beyond the terrain there is no mesh of which anything could be said.
    const within = widened(window, this.bounds, 0);
    const certificate = within[0] <= within[2] && within[1] <= within[3] ? certifiedWithin(this.certified, within) : null;
    return certificate === null ? null : { ...certificate, unit: this.units.height, window };
  }

  /** True when an error that was asked for is certified; none is for an error of 0, which asks for full detail. */
  protected isReached(error: number, window: Window): boolean {
    return error > 0 && (this.certifiedIn(window)?.error ?? Infinity) <= error;
  }

  /** Facts that the metadata of its stream tell. */
  protected get told(): Told { return this.about.told; }

  private get about(): { told: Told; frame: Frame } {
    if (this.described === null) {
      const told = toldBy(this.decoder.metadata);
      this.described = { told, frame: frameOf(this.decoder, told) };
    }
    return this.described;
  }
}

const named = (unit: string): string | null => (unit === 'unknown' ? null : unit);

/** Metres around the middle of the terrain, as long as there; degrees as at the middle parallel. */
function frameOf(decoder: Decoder, { ground }: Told): Frame {
  const { facts } = decoder;
  decoder.describe(ground);
  const middle = onMap(facts, (facts.minX + facts.maxX) / 2, (facts.minY + facts.maxY) / 2);
  const origin = [middle.x, middle.y, facts.minHeight <= facts.maxHeight ? facts.minHeight : 0] as const;
  if (ground === null) return { origin, scale: [1, 1, 1], unit: null };
  const [x, y] = decoder.metresPerMapUnit(middle);
  return { origin, scale: [x, y, ground.metres_per_height], unit: 'metre' };
}
