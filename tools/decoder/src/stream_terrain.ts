// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain whose stream was written before: in a file on a web host, or in bytes.
import type { ByteSource } from './byte_source.js';
import { type Certified, certifiedOf } from './certified.js';
import { Decoder } from './decoder.js';
import type { Window } from './map_window.js';
import { Problem } from './requests.js';
import { type RefineOptions, type State, Terrain } from './terrain.js';

export class StreamTerrain extends Terrain {
  readonly decoder: Decoder;
  /** Bytes that were not applied yet. */
  private left: Uint8Array = new Uint8Array(0);

  private constructor(module: WebAssembly.Module, private readonly source: ByteSource) {
    super();
    this.decoder = new Decoder(module);
  }

  /** Receives the first mesh. */
  static async open(module: WebAssembly.Module, source: ByteSource, signal?: AbortSignal): Promise<StreamTerrain> {
    const terrain = new StreamTerrain(module, source);
    while (!terrain.decoder.hasMesh) {
      if (!await terrain.applyNext(signal)) {
        throw new Problem('The stream ends too early', 'Its first part, without which nothing can be shown, is not whole.');
      }
    }
    source.rest();
    return terrain;
  }

  get bytes(): number { return this.source.bytes; }
  protected get certified(): Certified { return certifiedOf(this.decoder, this.told.request); }
  protected get window(): Window { return this.told.request.window ?? this.bounds; }

  protected async *receive(options: RefineOptions): AsyncGenerator<State, void, void> {
    const { error = 0, maxVertices = Infinity, maxBytes = Infinity, window = this.window, signal } = options;
    const { decoder, bytes } = this;
    for (;;) {
      signal?.throwIfAborted();
      if (this.isReached(error, window)) return yield 'reached';
      if (decoder.isComplete) return yield 'complete';
      if (decoder.mayExceed(maxVertices)) return yield 'vertices';
      if (this.left.length === 0 && this.bytes - bytes >= maxBytes) return yield 'bytes';
      const { splits } = decoder;
      if (!await this.applyNext(signal)) return yield 'cut';
      // The end of the stream follows its last split at once, and a step that is the last says why.
      const isLast = decoder.splits === decoder.splitsInAll || decoder.mayExceed(maxVertices) || this.isReached(error, window);
      if (decoder.splits !== splits && !isLast) yield 'refining';
    }
  }

  protected rest(): void { this.source.rest(); }

  /** Applies one frame, or what there is of it. Returns false at the end of the bytes. */
  private async applyNext(signal?: AbortSignal): Promise<boolean> {
    if (this.left.length === 0) {
      const next = await this.source.next(signal);
      if (next === null) return false;
      this.left = next;
    }
    this.left = this.left.subarray(this.decoder.feed(this.left, true));
    return true;
  }
}
