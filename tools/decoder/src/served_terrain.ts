// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain of `ptin serve`, of which each call asks for what is missing where it is wanted.
import type { Certified } from './certified.js';
import { type Collection, collectionAt, streamOf } from './collection.js';
import type { Decoder } from './decoder.js';
import { type Window, widened } from './map_window.js';
import { DecodeError } from './module.js';
import { Received, type Wanted, mostServings } from './received.js';
import { Problem, Tries } from './requests.js';
import { type RefineOptions, type State, Terrain } from './terrain.js';

/** Bytes of a piece that is asked for: each is twice as large as the one before, so that few are. */
const firstBytes = 64 * 1024, mostBytes = 16 * 1024 * 1024, leastBytes = 32 * 1024;

export class ServedTerrain extends Terrain {
  private readonly received: Received;
  private wanted: Window;
  private pieceBytes = firstBytes;

  private constructor(module: WebAssembly.Module, private readonly address: string, private readonly collection: Collection) {
    super();
    this.received = new Received(module);
    this.wanted = collection.bounds;
  }

  /**
   * Receives a first mesh of the whole terrain, within a hundredth of its relief.
   * @param address  Of the collection: http://host/collections/ID
   */
  static async open(module: WebAssembly.Module, address: string, signal?: AbortSignal): Promise<ServedTerrain> {
    const terrain = new ServedTerrain(module, address, await collectionAt(address, signal));
    const { bounds, heights: [least, greatest] } = terrain.collection;
    const first = { window: bounds, error: Math.max((greatest - least) / 100, 1e-6) };
    const tries = new Tries();
    while (!terrain.decoder.hasMesh) for await (const _ of terrain.piece(first, Infinity, tries, signal));
    return terrain;
  }

  /** The name that the service gives it. */
  get title(): string { return this.collection.title; }
  get decoder(): Decoder { return this.received.decoder; }
  get bytes(): number { return this.received.bytes; }
  protected get certified(): Certified { return this.received.certified; }
  protected get window(): Window { return this.wanted; }

  protected async *receive(options: RefineOptions): AsyncGenerator<State, void, void> {
    const { error = 0, maxVertices = Infinity, maxBytes = Infinity, signal } = options;
    const { received, received: { decoder }, bytes } = this;
    const tries = new Tries();
    this.wanted = widened(options.window ?? this.bounds, this.bounds, 0);
    const part = { window: this.wanted, error };
    while (!received.covers(part)) {
      signal?.throwIfAborted();
      const left = maxBytes - (this.bytes - bytes);
      if (left <= 0) return yield 'bytes';
      if (decoder.mayExceed(maxVertices)) return yield 'vertices';
      if (received.have.length >= mostServings) {
        throw new Problem('Too many parts', `This terrain was asked for ${mostServings} parts; open it anew to ask for more.`);
      }
      this.pieceBytes = Math.min(mostBytes, 2 * this.pieceBytes);
      for await (const _ of this.piece(part, left, tries, signal)) {
        if (!decoder.isComplete && decoder.mayExceed(maxVertices)) break;
        if (decoder.splits < decoder.splitsInAll) yield 'refining';
      }
    }
    // Below the error of the service's own file there is nothing.
    yield this.isReached(error, part.window) ? 'reached' : 'complete';
  }

  protected rest(): void {}

  /** Asks for a piece of a part, and applies it. What came of one that broke counts: the next one goes on from there. */
  private async *piece(part: Wanted, most: number, tries: Tries, signal?: AbortSignal): AsyncGenerator<void, void, void> {
    const { received } = this;
    const asked = received.asking(part, Math.max(1, Math.min(most, this.pieceBytes)));
    try {
      for await (const _ of received.take(part, await streamOf(this.address, asked, signal), signal)) {
        tries.succeed();
        yield;
      }
    } catch (error) {
      if (error instanceof DecodeError) throw error;
      if (!this.mends(error)) await tries.next(error, signal);
    }
  }

  /** Asks for less from now on where a piece was too large for the service. */
  private mends(error: unknown): boolean {
    const isTooLarge = error instanceof Problem && error.status === 413 && error.limit === 'most_stream_bytes';
    if (!isTooLarge || this.pieceBytes <= leastBytes) return false;
    this.pieceBytes = Math.max(leastBytes, this.pieceBytes / 4);
    return true;
  }
}
