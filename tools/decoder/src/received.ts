// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mesh that a receiver of `ptin serve` holds: each answer of /stream goes on from those before it, so only what is missing travels.
import type { Certified, CertifiedPart } from './certified.js';
import type { StreamBody } from './collection.js';
import { Decoder } from './decoder.js';
import { type Window, holds } from './map_window.js';
import { until } from './requests.js';

/** A part of the terrain, and the error at which it is wanted there, in the height's unit; 0: at full detail. */
export interface Wanted {
  window: Window;
  error: number;
}

/** A serving that a receiver had, as `ptin unstream` tells it and `ptin stream --have` takes it. */
export interface Serving {
  window: Window;
  error?: number;
  splits: number;
}

/** A service takes no more than 64 servings. */
export const mostServings = 60;

/** A decoder with what it was served. */
export class Received {
  readonly decoder: Decoder;
  readonly have: Serving[] = [];
  /** The bytes of all that came. */
  bytes = 0;
  private readonly whole: Wanted[] = [];
  /** The certificate of each serving, in its window. */
  private readonly parts: CertifiedPart[] = [];
  /** The window of the stream that is coming, once it has begun. */
  private coming: Window | null = null;
  /** The fingerprint of the file that answered: streams of another one cannot go on from this one's. */
  private fingerprint = '';

  constructor(module: WebAssembly.Module) {
    this.decoder = new Decoder(module);
  }

  /** Certificates by window, also while a stream comes. */
  get certified(): Certified {
    const { certificate } = this.decoder;
    return this.coming === null || certificate === null ? [...this.parts] : [...this.parts, { window: this.coming, ...certificate }];
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
    const body: StreamBody = { ...asked({ window, error }), max_bytes: mostBytes };
    if (this.have.length !== 0) body.have = this.have;
    if (this.have.length !== 0 && this.fingerprint !== '') body.fingerprint = this.fingerprint;
    return body;
  }

  /**
   * Takes the answer to asking(`wanted`), and yields whenever a frame was applied. Leaving the loop lets go of the answer.
   * Throws DecodeError, the reason of a signal, and what reading the body throws: what came counts, also when the connection broke,
   * and a further answer may follow; after damage none can.
   */
  async *take(wanted: Wanted, response: Response, signal?: AbortSignal): AsyncGenerator<void, void, void> {
    if (response.body === null) throw new TypeError('the answer to a stream has no body');
    this.fingerprint = response.headers.get('Ptin-Fingerprint') ?? this.fingerprint;
    const before = this.decoder.numbering;
    const reader = response.body.getReader();
    try {
      for (;;) {
        const { done, value } = await until(reader.read(), signal);
        if (done) break;
        this.bytes += value.length;
        for (let left: Uint8Array = value; left.length > 0;) {
          left = left.subarray(this.decoder.feed(left, true));
          if (this.decoder.numbering !== before) this.coming = wanted.window;
          yield;
        }
      }
    } finally {
      this.end(wanted);
      await reader.cancel().catch(() => undefined);  // It is broken, or read to its end.
    }
  }

  /** Notes what came of the stream that was asked for, all or a part: it counts for ever. */
  private end({ window, error }: Wanted): void {
    const { coming, decoder, decoder: { certificate, splits, isComplete } } = this;
    this.coming = null;
    // Even of one whose beginning broke off some bytes were taken.
    if (!isComplete) decoder.beginNext();
    if (coming === null || certificate === null) return;
    // All is there down to the error that is certified, of a piece that was cut, too. Details of no error may lack until nothing comes.
    const isAll = isComplete && splits === 0;
    this.whole.push({ window, error: isAll ? Math.min(error, certificate.error) : Math.max(certificate.error, Number.MIN_VALUE) });
    this.parts.push({ window: coming, ...certificate });
    this.have.push({ ...asked({ window, error }), splits });
  }
}

/** As services take it: without an error for full detail, which is more than an error of 0. */
function asked({ window, error }: Wanted): { window: Window; error?: number } {
  return error === 0 ? { window } : { window, error };
}
