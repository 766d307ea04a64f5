// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stream in a file on any web host: read from its first byte on, once, and decoded while it arrives. What came is kept, so
// that a coarser mesh can be made of it without the host.
import { Decoder, Problem } from 'ptin-decoder';

/** Bytes in the order in which they came, and a place in them. */
export class KeptBytes {
  private readonly chunks: Uint8Array[] = [];
  private chunk = 0;
  private offset = 0;
  /** The bytes of all that came. */
  bytes = 0;

  add(bytes: Uint8Array): void {
    if (bytes.length === 0) return;
    this.chunks.push(bytes);
    this.bytes += bytes.length;
  }

  /** The bytes that follow the place, as one piece; null when nothing has come yet. */
  next(): Uint8Array | null {
    const chunk = this.chunks[this.chunk];
    return chunk === undefined ? null : chunk.subarray(this.offset);
  }

  /** Moves the place on. `bytes` is at most the length of next(). */
  pass(bytes: number): void {
    this.offset += bytes;
    if (this.offset === this.chunks[this.chunk].length) {
      ++this.chunk;
      this.offset = 0;
    }
  }

  rewind(): void {
    this.chunk = 0;
    this.offset = 0;
  }
}

export interface Limits {
  /** The mesh is fine enough at this certified error; 0: never. */
  error: number;
  mostVertices: number;
}

/** A stream that is decoded while it comes, and anew when the limits ask for a coarser mesh than is there. */
export class StaticStream {
  readonly kept = new KeptBytes();
  /** The decoder whose mesh is shown. */
  decoder: Decoder;
  /** Catches up with coarser limits, and then takes the place of `decoder`. */
  private next: Decoder | null = null;
  /** Certified after each frame from T0 on, as far as it was decoded once. */
  private readonly errors: number[] = [];
  private frames = 0;

  constructor(private readonly module: WebAssembly.Module, private readonly limits: Limits) {
    this.decoder = new Decoder(module);
  }

  /** Why no more is applied; null: there is more to apply. */
  get heldBy(): 'error' | 'vertices' | null {
    const decoder = this.next ?? this.decoder;
    const { certificate } = decoder;
    if (certificate === null || decoder.isComplete) return null;
    if (this.limits.error > 0 && certificate.error <= this.limits.error) return 'error';
    return decoder.mayExceed(this.limits.mostVertices) ? 'vertices' : null;
  }

  setError(error: number): void {
    this.limits.error = error;
    const enough = error > 0 ? this.errors.findIndex((e) => e <= error) : -1;
    if (enough < 0 || enough >= this.frames - 1) return;
    this.next = new Decoder(this.module);
    this.kept.rewind();
    this.frames = 0;
  }

  /**
   * Applies frames of what was kept until there are none, the limits hold, or `milliseconds` are over.
   * Returns false when there is nothing more to do for now.
   */
  apply(milliseconds: number): boolean {
    const end = performance.now() + milliseconds;
    const decoder = this.next ?? this.decoder;
    while (this.heldBy === null) {
      const bytes = this.kept.next();
      if (bytes === null) break;
      if (decoder.isComplete) {
        throw new Problem('The stream goes on behind its end', 'Only the first stream of a file is shown.');
      }
      this.kept.pass(decoder.feed(bytes, true));
      this.note(decoder);
      if (performance.now() > end) return true;
    }
    if (this.next !== null) {
      this.decoder = this.next;
      this.next = null;
    }
    return false;
  }

  private splitsNoted = -1;
  private note(decoder: Decoder): void {
    const { certificate, splits } = decoder;
    if (certificate === null) {
      this.splitsNoted = -1;
    } else if (splits !== this.splitsNoted) {
      this.splitsNoted = splits;
      this.errors[this.frames++] = certificate.error;
    }
  }
}
