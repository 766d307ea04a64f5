// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stream from anywhere, decoded while it comes.
import { Decoder } from './decoder.js';
import { DecodeError } from './module.js';

/** Where bytes come from. An address is fetched; an answer must be one of success. */
export type StreamSource =
  | string | URL | Response | ReadableStream<Uint8Array> | AsyncIterable<Uint8Array> | Iterable<Uint8Array> | Uint8Array | ArrayBuffer;

export interface StreamOptions {
  /** Ends once this is certified, in the height's unit; 0: all that comes. */
  error?: number;
  /** Ends before the mesh may have more vertices; T0 comes in any case. */
  mostVertices?: number;
  /** Ends the stream, and the request, by an AbortError. */
  signal?: AbortSignal;
  /** Milliseconds between two yields; 0: after each frame. Default 50. */
  every?: number;
}

/** Vertices behind the next frame, at most: a sender puts an eighth of the mesh into one, and at least 256 (FORMAT.md). */
const grown = (vertices: number): number => vertices + Math.max(256, vertices / 8);

/**
 * Yields the same decoder again and again, each time with a valid mesh that is finer than before, from the coarsest on, and once
 * more when the stream ends or an option ends it. `decoder.isComplete` tells whether all came: a connection that broke ends the
 * stream as its end does. Leaving the loop ends the request.
 *
 * @throws DecodeError  damage, another format, no mesh at all; what came before stays in the decoder that was yielded
 * @throws TypeError    the address could not be fetched
 */
export async function* decodeStream(
  module: WebAssembly.Module, source: StreamSource, options: StreamOptions = {},
): AsyncGenerator<Decoder, void, undefined> {
  const { error = 0, mostVertices = Infinity, signal, every = 50 } = options;
  const decoder = new Decoder(module);
  const isEnough = (): boolean => decoder.hasMesh && (
    decoder.isComplete || (error > 0 && decoder.certificate.error <= error) ||
    grown(decoder.mesh.vertexCount) > mostVertices);
  let yielded = performance.now();
  for await (const chunk of chunksOf(source, signal)) {
    for (let rest = chunk; rest.length > 0 && !isEnough();) {
      signal?.throwIfAborted();
      rest = rest.subarray(decoder.feed(rest, true));
      if (!decoder.hasMesh || isEnough() || performance.now() - yielded < every) continue;
      yield decoder;
      yielded = performance.now();
    }
    if (isEnough()) break;
  }
  if (!decoder.hasMesh) throw new DecodeError('corruption', 'the stream ends before its first mesh is whole');
  yield decoder;
}

/** The bytes of a source, in order. A connection that breaks ends them as their end does, unless it was asked to. */
async function* chunksOf(source: StreamSource, signal?: AbortSignal): AsyncGenerator<Uint8Array, void, undefined> {
  if (source instanceof Uint8Array) {
    yield source;
  } else if (source instanceof ArrayBuffer) {
    yield new Uint8Array(source);
  } else if (typeof source === 'string' || source instanceof URL) {
    yield* chunksOf(await fetch(source, { signal }), signal);
  } else if (source instanceof Response) {
    if (!source.ok) throw new TypeError(`${source.url || 'the host'} answered ${source.status} ${source.statusText}`.trim());
    if (source.body !== null) yield* chunksOf(source.body, signal);
  } else if (source instanceof ReadableStream) {
    yield* read(source.getReader(), signal);
  } else {
    yield* source;
  }
}

async function* read(reader: ReadableStreamDefaultReader<Uint8Array>, signal?: AbortSignal): AsyncGenerator<Uint8Array, void, undefined> {
  const cancel = (): void => { reader.cancel(signal?.reason).catch(() => undefined); };
  signal?.addEventListener('abort', cancel);
  try {
    for (;;) {
      signal?.throwIfAborted();
      const { done, value } = await reader.read().catch(() => ({ done: true, value: undefined } as const));
      signal?.throwIfAborted();
      if (done) return;
      yield value;
    }
  } finally {
    signal?.removeEventListener('abort', cancel);
    cancel();
  }
}
