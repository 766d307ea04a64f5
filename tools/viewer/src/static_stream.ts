// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stream in a file on any web host: read from its first byte on, once, and decoded while it arrives. What came is kept, so
// that a coarser mesh can be made of it without the host.
import { Decoder } from 'ptin-decoder';
import { Problem, opened } from './fetching';

/** Bytes in the order in which they came, and a place in them. */
export class KeptBytes {
  private readonly chunks: Uint8Array[] = [];
  private chunk = 0;
  private offset = 0;
  /** Of all that came. */
  bytes = 0;

  add(bytes: Uint8Array): void {
    if (bytes.length === 0) return;
    this.chunks.push(bytes);
    this.bytes += bytes.length;
  }

  /** What follows the place, as one piece; null when nothing has come yet. */
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
  /** Whose mesh is shown. */
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
    if (!decoder.hasMesh || decoder.isComplete) return null;
    if (this.limits.error > 0 && decoder.certificate.error <= this.limits.error) return 'error';
    // A frame may bring an eighth more.
    return decoder.mesh.vertexCount * 1.125 > this.limits.mostVertices ? 'vertices' : null;
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
    if (!decoder.hasMesh) {
      this.splitsNoted = -1;
    } else if (decoder.splits !== this.splitsNoted) {
      this.splitsNoted = decoder.splits;
      this.errors[this.frames++] = decoder.certificate.error;
    }
  }
}

export interface OpenedStream {
  reader: ReadableStreamDefaultReader<Uint8Array>;
  /** 0: the host does not say, or says it of packed bytes. */
  bytesInAll: number;
}

export async function openStream(url: string): Promise<OpenedStream> {
  const response = await opened(url);
  if (response.body === null) throw new Problem('The terrain is empty', 'The host answered without any bytes.');
  const packed = response.headers.get('Content-Encoding');
  const length = packed === null || packed === 'identity' ? Number(response.headers.get('Content-Length') ?? 0) : 0;
  return { reader: response.body.getReader(), bytesInAll: length };
}
