// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh that a receiver of `ptin serve` holds: each answer of /stream goes on from those before it, so only what is missing travels.
import type { Certified, CertifiedPart } from './certified.js';
import { Decoder } from './decoder.js';
import { type Window, holds } from './map_window.js';

/** A part of the terrain, and the error at which it is wanted there, in the height's unit. */
export interface Wanted {
  window: Window;
  error: number;
}

/** What a receiver was served, as `ptin unstream` tells it and `ptin stream --have` takes it. */
export interface Serving extends Wanted {
  splits: number;
}

/** What POST .../stream takes. */
export interface StreamBody extends Wanted {
  max_bytes: number;
  have?: readonly Serving[];
  fingerprint?: string;
}

/** A decoder with what it was served. */
export class Received {
  readonly decoder: Decoder;
  readonly have: Serving[] = [];
  private readonly whole: Wanted[] = [];
  /** The certificate of each serving, in its window. */
  private readonly parts: CertifiedPart[] = [];
  /** The window of the stream that is coming, once it has begun. */
  private coming: Window | null = null;
  /** Of the file that answered: streams of another one cannot go on from this one's. */
  private fingerprint = '';

  constructor(module: WebAssembly.Module) {
    this.decoder = new Decoder(module);
  }

  /** What is certified where, also while a stream comes. */
  get certified(): Certified {
    const now = this.coming === null ? [] : [{ window: this.coming, ...this.decoder.certificate }];
    return { parts: [...this.parts, ...now], otherwise: this.decoder.certificateByRelief };
  }

  /** True when all of `wanted` was served at its error, or at a smaller one. */
  covers(wanted: Wanted): boolean {
    return this.whole.some((w) => w.error <= wanted.error && holds(w.window, wanted.window));
  }

  /** Passes what is wanted off as covered: of a service that has not the memory for it. */
  giveUp(wanted: Wanted): void {
    this.whole.push(wanted);
  }

  /** The body of a request for what lacks of `wanted`, in at most so many bytes. */
  asking({ window, error }: Wanted, mostBytes: number): StreamBody {
    const body: StreamBody = { window, error, max_bytes: mostBytes };
    if (this.have.length !== 0) body.have = this.have;
    if (this.have.length !== 0 && this.fingerprint !== '') body.fingerprint = this.fingerprint;
    return body;
  }

  /**
   * Takes the answer to asking(`wanted`). `grown` is told of all bytes that came; the mesh may have changed then.
   * Throws DecodeError, and what reading the body throws: a connection that broke leaves what came, and a further answer may follow;
   * after damage nothing can.
   */
  async take(wanted: Wanted, response: Response, grown: (bytes: number) => void = () => undefined): Promise<void> {
    if (response.body === null) throw new TypeError('the answer to a stream has no body');
    this.fingerprint = response.headers.get('Ptin-Fingerprint') ?? this.fingerprint;
    const { decoder } = this;
    const before = decoder.numbering;
    const reader = response.body.getReader();
    try {
      for (;;) {
        const { done, value } = await reader.read();
        if (done) break;
        decoder.feed(value);
        if (decoder.numbering !== before) this.coming = wanted.window;
        grown(value.length);
      }
      const isWhole = decoder.isComplete && (decoder.certificate.error <= wanted.error || decoder.splits === 0);
      if (isWhole) this.whole.push({ window: wanted.window, error: wanted.error });
    } finally {
      this.end(wanted);
    }
  }

  /** Notes what came of the stream that was asked for, all or a part: it counts for ever. */
  private end({ window, error }: Wanted): void {
    if (this.coming === null) return;
    const { decoder } = this;
    this.parts.push({ window: this.coming, ...decoder.certificate });
    this.have.push({ window, error, splits: decoder.splits });
    this.coming = null;
    if (!decoder.isComplete) decoder.beginNext();
  }
}
