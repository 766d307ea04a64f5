// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stream in a file on a web host whose connection breaks, which knows ranges of bytes or not, and whose file is replaced.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import type { IncomingMessage, ServerResponse } from 'node:http';
import { test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { openBytes, openFile } from '../src/index';
import { host } from './host.mjs';
import { decoderModule, folder, isSameMesh, terrain } from './support';

const wasm = decoderModule();
const { stream } = terrain('mountains_257', '--error', '1');
const bytes = new Uint8Array(readFileSync(stream));
const other = bytes.map((b, i) => (i === 2000 ? b ^ 1 : b));

interface Host {
  ranges?: boolean;
  /** Bytes of each answer, behind which the connection breaks. */
  breaks?: (answer: number) => number;
  /** Names of the file's version, of each answer. */
  names?: (answer: number) => Record<string, string>;
  status?: (answer: number) => number;
  /** The file of each answer. */
  given?: (answer: number) => Uint8Array;
  length?: boolean;
}

/** A host of the stream, and what was asked of it. */
async function hosted(
  { ranges = true, breaks = () => Infinity, names = () => ({ ETag: '"a"' }), status = () => 200, given = () => bytes, length = true }: Host,
  use: (url: string, asked: Array<IncomingMessage['headers']>) => Promise<void>,
): Promise<void> {
  const asked: Array<IncomingMessage['headers']> = [];
  const answer = ({ headers }: IncomingMessage, response: ServerResponse): boolean => {
    const number = asked.push(headers) - 1, all = given(number), named = names(number);
    const refuse = (by: number): boolean => {
      response.writeHead(by).end();
      return true;
    };
    if (status(number) !== 200) return refuse(status(number));
    const range = /^bytes=(\d+)-$/.exec(headers.range ?? '');
    const isOther = headers['if-range'] !== undefined && headers['if-range'] !== named.ETag;
    const begin = ranges && range !== null && !isOther ? Number(range[1]) : 0;
    if (begin > all.length) return refuse(416);
    response.writeHead(begin > 0 ? 206 : 200, {
      ...named, ...(length ? { 'Content-Length': all.length - begin } : {}),
      ...(begin > 0 ? { 'Content-Range': `bytes ${begin}-${all.length - 1}/${all.length}` } : {}),
    });
    // In portions, so that a client which has enough is heard.
    const send = (at: number): void => {
      const end = Math.min(at + 4000, all.length, begin + breaks(number));
      response.write(all.subarray(at, end), () => {
        setTimeout(() => {
          if (end - begin >= breaks(number)) response.destroy();
          else if (end === all.length) response.end();
          else send(end);
        }, 1);
      });
    };
    send(begin);
    return true;
  };
  const web = await host(folder, { answer });
  try {
    await use(`${web.url}m.ptins`, asked);
  } finally {
    await web.close();
  }
}

const whole = await (await openBytes(bytes, { wasm })).refined({ positions: 'map' });
const isWhole = async (url: string): Promise<void> => {
  const step = await (await openFile(url, { wasm })).refined({ positions: 'map' });
  assert.deepEqual([step.state, step.bytes], ['complete', bytes.length]);
  assert.ok(isSameMesh(step, whole));
};

test('a file is read as far as it is wanted, and on from there by a range of the same file', () => hosted({}, async (url, asked) => {
  const opened = await openFile(url, { wasm });
  assert.equal((await opened.refined({ error: 20 })).state, 'reached');
  const read = opened.bytes;
  assert.ok(read < bytes.length / 2);
  assert.equal(asked.length, 1, 'one connection is enough for what is wanted at once');
  await new Promise((resolve) => { setTimeout(resolve, 300); });
  assert.equal((await opened.refined()).state, 'complete');
  assert.equal(opened.bytes, bytes.length);
  assert.deepEqual(asked.map((h) => [h.range, h['if-range']]), [[undefined, undefined], [`bytes=${read}-`, '"a"']]);
  assert.ok(isSameMesh(opened.mesh({ positions: 'map' }), whole));
}));

test('a connection that breaks in the middle is taken up, by a range or from the beginning', async () => {
  const breaks = (answer: number): number => [10000, 3000, 30000][answer] ?? Infinity;
  // Their pauses are shared.
  await Promise.all([
    hosted({ breaks }, async (url, asked) => {
      await isWhole(url);
      assert.deepEqual(asked.map((h) => h.range), [undefined, 'bytes=10000-', 'bytes=13000-', 'bytes=43000-']);
    }),
    hosted({ breaks, ranges: false }, isWhole),
    hosted({ breaks: (answer) => [20000, 30000][answer] ?? Infinity, names: () => ({}), length: false }, async (url, asked) => {
      await isWhole(url);
      assert.deepEqual(asked.map((h) => h.range), [undefined, undefined, undefined], 'a file without a name is compared');
    }),
    // A host that is busy in between.
    hosted({ breaks, status: (answer) => (answer === 1 ? 503 : 200) }, isWhole),
  ]);
});

test('a file that was cut ends where it ends, whatever its host says of its length', async () => {
  const cut = bytes.subarray(0, 40000);
  await hosted({ given: () => cut }, async (url, asked) => {
    const opened = await openFile(url, { wasm });
    for (let i = 0; i < 2; ++i) assert.equal((await opened.refined()).state, 'cut');
    assert.equal(asked.length, 1);
  });
  // A length of packed bytes that a page cannot know to be one.
  const packed = deflateSync(bytes);
  const names = (): Record<string, string> => ({ ETag: '"a"', 'Content-Encoding': 'deflate' });
  await hosted({ given: () => packed, names, breaks: (answer) => (answer === 0 ? 30000 : Infinity) }, isWhole);
});

test('a host that is gone for good is given up after few tries, and what came stays', async () => {
  await Promise.all([
    hosted({ breaks: (answer) => (answer === 0 ? 20000 : 0) }, async (url, asked) => {
      const opened = await openFile(url, { wasm });
      await assert.rejects(opened.refined(), { name: 'Problem', title: 'The connection broke', status: 0, message: /stopped in the middle/ });
      assert.equal(asked.length, 4);
      assert.ok(opened.mesh().indices.length > 1000);
    }),
    hosted({ breaks: () => 20000, status: (answer) => (answer === 0 ? 200 : 404) }, async (url, asked) => {
      const opened = await openFile(url, { wasm });
      await assert.rejects(opened.refined(), { name: 'Problem', status: 404 });
      assert.equal(asked.length, 2, 'what is refused is not asked for again');
    }),
    hosted({ breaks: () => 20000 }, async (url) => {
      const opened = await openFile(url, { wasm });
      const abort = new AbortController();
      const refining = (async () => { for await (const _ of opened.refine({ signal: abort.signal, growth: 1 })) abort.abort(); })();
      await assert.rejects(refining, { name: 'AbortError' });
    }),
  ]);
});

test('bytes of two files are never put together', async () => {
  const breaks = (answer: number): number => (answer === 0 ? 20000 : Infinity);
  const given = (answer: number): Uint8Array => (answer === 0 ? bytes : other);
  const isReplaced = async (url: string): Promise<void> => {
    const opened = await openFile(url, { wasm });
    await assert.rejects(opened.refined(), { name: 'Problem', title: 'The terrain was replaced' });
  };
  const day = (answer: number): string => `Sat, 0${1 + Math.min(answer, 1)} Nov 2025 00:00:00 GMT`;
  await Promise.all([
    hosted({ breaks, given, names: (answer) => ({ ETag: answer === 0 ? '"a"' : '"b"' }) }, isReplaced),
    hosted({ breaks, given, names: (answer) => ({ ETag: answer === 0 ? 'W/"a"' : 'W/"b"' }) }, isReplaced),
    hosted({ breaks, given, names: (answer) => ({ 'Last-Modified': day(answer) }) }, isReplaced),
    hosted({ breaks, given, names: () => ({}), length: false }, isReplaced),
    hosted({ breaks, given: (answer) => (answer === 0 ? bytes : bytes.subarray(0, 9000)), names: () => ({ ETag: 'W/"a"' }) }, isReplaced),
    hosted({ breaks, given: (answer) => (answer === 0 ? bytes : bytes.subarray(0, 9000)), ranges: false }, isReplaced),
  ]);
});

test('a file that is not there, and a host that is not, are problems in a sentence', async () => {
  const web = await host(folder);
  await assert.rejects(openFile(`${web.url}none.ptins`, { wasm }), { name: 'Problem', status: 404, message: /none\.ptins/ });
  await web.close();
  await assert.rejects(openFile(`${web.url}none.ptins`, { wasm }), { name: 'Problem', status: 0, message: /did not answer/ });
  await assert.rejects(openFile('m.ptins', { wasm }), { name: 'Problem', message: /no address on a web host[^]*openBytes/ });
});
