// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a stream in the order in which they are decoded: from a file on a web host, or from memory.
import { Problem, Tries, here, opened, until } from './requests.js';

export interface ByteSource {
  /** The bytes of all that came. */
  readonly bytes: number;
  /** The next bytes, which stay as they are; null at the end. Throws what keeps them away, and may be called again then. */
  next(signal?: AbortSignal): Promise<Uint8Array | null>;
  /** Nothing is wanted for some time: lets go of connections, unless more is wanted at once. */
  rest(): void;
}

/** Milliseconds for which a connection is kept that nothing is wanted of. */
const kept = 100;

/** A file as its host named it: by that another one is known. */
interface Version {
  etag: string | null;
  modified: string | null;
  /** 0: the host does not say, or says it of packed bytes. Pages are not told whether bytes of another host are packed. */
  bytesInAll: number;
}

/**
 * A file on a web host, read once from its first byte on. After a rest, or when the connection breaks, it is read on from there by
 * a range of bytes; of a host that knows none all is fetched again, and what was there already passed over. Bytes of two files are
 * never put together: a file that was replaced is a Problem.
 */
export class HostedBytes implements ByteSource {
  bytes = 0;
  private reader: ReadableStreamDefaultReader<Uint8Array> | null = null;
  private hasEnded = false;
  private version: Version | null = null;
  private isPacked = false;
  /** A hash of the bytes that came, where the host names no version. */
  private sum = firstSum;
  /** Bytes that came behind those that were passed over. */
  private over: Uint8Array | null = null;
  private letGo: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly url: string) {}

  /** 0: the host does not say, or says it of packed bytes. */
  get bytesInAll(): number { return this.version?.bytesInAll ?? 0; }

  /** Asks the host, so that its refusal is known before anything is read. Throws Problem. */
  async open(signal?: AbortSignal): Promise<this> {
    if (this.reader === null) await this.connect(signal);
    return this;
  }

  async next(signal?: AbortSignal): Promise<Uint8Array | null> {
    clearTimeout(this.letGo);
    const tries = new Tries();
    while (!this.hasEnded) {
      try {
        signal?.throwIfAborted();
        const value = await this.received(signal);
        if (value !== null) return value;
        this.hasEnded = true;
      } catch (error) {
        await this.close();
        if (isBehindEnd(error)) {
          if (this.bytes !== this.bytesInAll) throw replaced(416);
          this.hasEnded = true;
        } else {
          await tries.next(error, signal);
        }
      }
    }
    return null;
  }

  rest(): void {
    clearTimeout(this.letGo);
    if (this.reader !== null) this.letGo = setTimeout(() => void this.close(), kept);
  }

  private async close(): Promise<void> {
    const { reader } = this;
    this.reader = this.over = null;
    await reader?.cancel().catch(() => undefined);  // It is broken, or is now.
  }

  private async received(signal?: AbortSignal): Promise<Uint8Array | null> {
    await this.open(signal);
    const value = this.over ?? (await until(this.reader!.read(), signal)).value;
    this.over = null;
    if (value === undefined) return null;
    this.bytes += value.length;
    if (this.isUnnamed) this.sum = summed(this.sum, value);
    return value;
  }

  private async connect(signal?: AbortSignal): Promise<void> {
    const headers = this.wantedRange();
    const response = await opened(this.url, { signal: signal ?? null, headers });
    if (response.body === null) throw new Problem('The terrain is empty', 'The host answered without any bytes.', response.status);
    this.reader = response.body.getReader();
    this.compare(response, 'If-Range' in headers && response.status === 206);
    if (this.bytes > 0 && response.status !== 206) await this.passOver(this.reader, signal);
  }

  /** The host names neither version of its file. */
  private get isUnnamed(): boolean {
    return this.version !== null && this.version.etag === null && this.version.modified === null;
  }

  /** The rest, of this file alone. A file without a name is asked for whole, so that what came can be compared. */
  private wantedRange(): Record<string, string> {
    if (this.bytes === 0 || this.isPacked || this.isUnnamed) return {};
    const range = { Range: `bytes=${this.bytes}-` };
    const page = here(), etag = this.version?.etag ?? null;
    // A page would have to ask another host for leave to send If-Range, which few give.
    const isOther = page !== undefined && new URL(this.url, page).origin !== new URL(page).origin;
    return isOther || etag === null || etag.startsWith('W/') ? range : { ...range, 'If-Range': etag };
  }

  /** Holds an answer to the first one. `isSure`: the host compared the file itself. */
  private compare({ headers, status }: Response, isSure: boolean): void {
    const range = /^bytes (\d+)-\d+\/(\d+|\*)$/.exec(headers.get('Content-Range') ?? '');
    const packing = headers.get('Content-Encoding');
    const isPacked = packing !== null && packing !== 'identity';
    const length = Number(status === 206 ? range?.[2] : headers.get('Content-Length')) || 0;
    const now: Version = { etag: headers.get('ETag'), modified: headers.get('Last-Modified'), bytesInAll: isPacked ? 0 : length };
    if (this.version === null || this.bytes === 0) {
      this.version = now;
      this.isPacked = isPacked;
    } else if (!isSame(this.version, now, isSure || this.isUnnamed)) {
      throw replaced(status);
    } else if (status === 206 && range !== null && Number(range[1]) !== this.bytes) {
      throw new Problem('The host failed', 'It gave out another range of bytes than was asked for.', status);
    }
  }

  private async passOver(reader: ReadableStreamDefaultReader<Uint8Array>, signal?: AbortSignal): Promise<void> {
    let sum = firstSum;
    for (let left = this.bytes; left > 0;) {
      const { done, value } = await until(reader.read(), signal);
      if (done) throw replaced(200);
      if (this.isUnnamed) sum = summed(sum, value.subarray(0, left));
      left -= value.length;
      if (left < 0) this.over = value.subarray(value.length + left);
    }
    if (sum !== this.sum) throw replaced(200);
  }
}

/** True when one name at least is the same, and none differs; `isSure`: where none is told again, too. */
function isSame(before: Version, now: Version, isSure: boolean): boolean {
  if (before.bytesInAll !== 0 && now.bytesInAll !== 0 && before.bytesInAll !== now.bytesInAll) return false;
  const told = (['etag', 'modified'] as const).filter((name) => before[name] !== null && now[name] !== null);
  return told.every((name) => before[name] === now[name]) && (isSure || told.length > 0);
}

/** The host has nothing at the place from which it was asked on. */
const isBehindEnd = (error: unknown): boolean => error instanceof Problem && error.status === 416;

/** The Problem of a status that is no failure of the host: trying again would not help. */
function replaced(status: number): Problem {
  return new Problem('The terrain was replaced', 'The host has another file now; open it anew.', status);
}

/** FNV-1a of 32 bits, byte by byte. */
const firstSum = 0x811c9dc5;
function summed(sum: number, bytes: Uint8Array): number {
  for (const byte of bytes) sum = Math.imul(sum ^ byte, 0x01000193);
  return sum;
}

/** Where the bytes of a stream may be: all at hand, or coming. */
export type Bytes =
  | ArrayBuffer | ArrayBufferView | Blob | Response | ReadableStream<Uint8Array> | AsyncIterable<Uint8Array> | Iterable<Uint8Array>;

/** Bytes that somebody else has; theirs stay as they are. */
export class GivenBytes implements ByteSource {
  bytes = 0;
  private readonly read: () => Promise<Uint8Array | null>;
  private coming: Promise<Uint8Array | null> | null = null;

  constructor(given: Bytes) {
    this.read = readerOf(given);
  }

  async next(signal?: AbortSignal): Promise<Uint8Array | null> {
    signal?.throwIfAborted();
    // Bytes that come behind an abortion are not lost: the next call gets them.
    this.coming ??= this.read();
    const value = await until(this.coming, signal);
    this.coming = null;
    this.bytes += value?.length ?? 0;
    return value;
  }

  rest(): void {}
}

/** Kinds are told by what they can do: those of other realms, as of test frames, are instances of other classes. */
function readerOf(given: Bytes): () => Promise<Uint8Array | null> {
  if (typeof given !== 'object' || given === null) {
    throw new TypeError('openBytes() takes bytes, or where they come from; an address is opened by openFile()');
  }
  if (ArrayBuffer.isView(given)) return iterated([new Uint8Array(given.buffer, given.byteOffset, given.byteLength)]);
  if ('byteLength' in given) return iterated([new Uint8Array(given)]);
  if ('ok' in given) {
    if (!given.ok) throw new Problem(`The host answered ${given.status}`, 'That is no stream.', given.status);
    return given.body === null ? iterated([]) : readerOf(given.body);
  }
  if ('stream' in given) return readerOf(given.stream());
  if (!('getReader' in given)) return iterated(given);
  const reader = given.getReader();
  return async () => (await reader.read()).value ?? null;
}

function iterated(given: AsyncIterable<Uint8Array> | Iterable<Uint8Array>): () => Promise<Uint8Array | null> {
  const iterator = Symbol.asyncIterator in given ? given[Symbol.asyncIterator]() : given[Symbol.iterator]();
  return async () => {
    const { done, value } = await iterator.next();
    return done === true ? null : value as Uint8Array;
  };
}
