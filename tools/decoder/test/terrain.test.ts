// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains as clients see them: against the program at the same error, with budgets, signals, damage, and a service.
import assert from 'node:assert/strict';
import { createReadStream, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { runInNewContext } from 'node:vm';
import {
  type Bytes, DecodeError, Problem, type RefineOptions, type StreamTerrain, type Step, type Terrain, certifiedAt, certifiedOf, loadModule,
  mapCrsOf, openBytes, openServed,
} from '../src/index';
import { host } from './host.mjs';
import { assets, decoderModule, file, folder, isSameMesh, made, ptin, served, terrain, trianglesOfArrays, trianglesOfPly } from './support';

const wasm = decoderModule();
const { store, stream } = terrain('mountains_257', '--error', '1');
const bytes = new Uint8Array(readFileSync(stream));
const from = (given: Bytes, signal?: AbortSignal): Promise<StreamTerrain> => openBytes(given, { wasm, signal });
const all = async (terrain: Terrain, options: RefineOptions = {}): Promise<Step[]> => {
  const steps: Step[] = [];
  for await (const step of terrain.refine(options)) steps.push(step);
  return steps;
};
const last = <T>(steps: T[]): T => steps[steps.length - 1];

/** The surface of the program at an error. */
const surfaces = new Map<string, string[]>();
function refined(path: string, ...options: string[]): string[] {
  const name = [path, ...options].join(' ');
  if (!surfaces.has(name)) {
    ptin('refine', path, ...options, '-o', file('refined.ply'), '--overwrite', '-q');
    surfaces.set(name, trianglesOfPly(file('refined.ply')));
  }
  return surfaces.get(name)!;
}

/** Bytes that come a thousand at once; behind `stopsAt` none, for ever. */
async function* trickled(given: Uint8Array, stopsAt = Infinity): AsyncGenerator<Uint8Array> {
  for (let at = 0; at < given.length; at += 1000) {
    if (at > stopsAt) await new Promise(() => undefined);
    yield given.subarray(at, at + 1000);
  }
}

test('bytes from anywhere are the surface of the program, triangle by triangle', async () => {
  const sources: Bytes[] = [
    bytes, bytes.slice().buffer, new Blob([bytes]), new Response(bytes), new Blob([bytes]).stream(), trickled(bytes),
    [bytes.subarray(0, 5000), bytes.subarray(5000)], createReadStream(stream),
    ...runInNewContext('const of = new Uint8Array(given); [of, of.buffer]', { given: bytes }) as Bytes[],
  ];
  const whole = await (await from(bytes)).refined({ positions: 'map' });
  assert.deepEqual(trianglesOfArrays(whole), refined(store, '--error', '1'));
  for (const source of sources) {
    const step = await (await from(source)).refined({ positions: 'map' });
    assert.deepEqual([step.state, step.certified?.error, step.bytes], ['complete', 1, bytes.length]);
    assert.ok(isSameMesh(step, whole));
  }
  await assert.rejects(from(stream as unknown as Bytes), /openBytes\(\) takes bytes[^]*openFile\(\)/);
});

test('voids stay open', async () => {
  const { store: voids, stream: stillVoids } = made('voids', '--error', '5');
  const opened = await from(readFileSync(stillVoids));
  assert.deepEqual(trianglesOfArrays(await opened.refined({ positions: 'map' })), refined(voids, '--error', '5'));
  const heights = opened.mesh({ positions: 'map' }).positions.filter((_, i) => i % 3 === 2);
  assert.deepEqual([Math.min(...heights), Math.max(...heights)], opened.heights, 'a vertex in a void spoils no box');
});

test('steps become finer, and stop at an error, at a budget, and where bytes end', async () => {
  const opened = await from(trickled(bytes));
  const coarse = await all(opened, { error: 20 });
  assert.ok(coarse.length > 2);
  assert.deepEqual(coarse.map((s) => s.state), coarse.map((_, i) => (i === coarse.length - 1 ? 'reached' : 'refining')));
  for (let i = 1; i < coarse.length; ++i) assert.ok(coarse[i].certified!.error <= coarse[i - 1].certified!.error);
  assert.ok(last(coarse).certified!.error <= 20 && last(coarse).certified!.error > 10);
  assert.ok(last(coarse).bytes < bytes.length / 2, 'no more is taken than is needed');
  const budget = await opened.refined({ maxVertices: 5000 });
  assert.equal(budget.state, 'vertices');
  assert.ok(budget.positions.length <= 3 * 5000);
  assert.equal((await opened.refined({ maxBytes: 4000 })).state, 'bytes');
  assert.ok(opened.bytes > budget.bytes && opened.bytes <= budget.bytes + 5000);
  assert.equal((await opened.refined()).state, 'complete');
  assert.equal((await (await from(bytes.subarray(0, 9000))).refined()).state, 'cut');
});

test('local positions are metres around the middle', async () => {
  const degrees = await from(readFileSync(made('degrees').stream));
  const { positions } = await degrees.refined({ error: 50 });
  const { frame, bounds: [west, south, east, north], heights } = degrees;
  assert.equal(frame.unit, 'metre');
  const [perX, perY] = frame.scale;
  assert.ok(Math.abs(perY - 110900) < 300 && Math.abs(perX / perY - Math.cos(frame.origin[1] * Math.PI / 180)) < 0.01);
  const xs = positions.filter((_, i) => i % 3 === 0), zs = positions.filter((_, i) => i % 3 === 2);
  assert.ok(Math.abs(Math.max(...xs) - (east - west) / 2 * frame.scale[0]) < 1);
  assert.ok(Math.min(...zs) >= 0 && Math.max(...zs) <= heights![1] - heights![0] + 0.01);
  assert.ok(south < frame.origin[1] && frame.origin[1] < north);
  assert.equal(degrees.units.horizontal, 'degree');
});

test('nothing is certified where nothing is known', async () => {
  const isolines = await from(readFileSync(terrain('mountains_257', '--level', '1000', '--error', '5').stream));
  const step = await isolines.refined({ error: 5 });
  assert.deepEqual([step.certified, step.state], [null, 'complete'], 'certified along isolines alone');
  assert.equal(isolines.units.height, null, 'its CRS has no heights');
  const [west, south, east, north] = isolines.bounds;
  const middle = { x: (west + east) / 2, y: (south + north) / 2 };
  assert.equal(certifiedAt(certifiedOf(isolines.decoder), [middle]), null);
  // A window: beyond it there is no more than T0, and of the whole terrain nothing is known.
  const window = [west, south, middle.x, middle.y] as const;
  const part = await from(readFileSync(terrain('mountains_257', '--window', ...window.map(String), '--error', '5').stream));
  assert.ok((await part.refined({ error: 5 })).certified!.error <= 5);
  const everywhere = await part.refined({ error: 5, window: part.bounds });
  assert.deepEqual([everywhere.certified, everywhere.state], [null, 'complete'], 'an error that is not certified was not reached');
  assert.ok(part.certifiedIn(window)!.error <= 5);
  assert.equal(part.certifiedIn([west, south, east, south + 1]), null);
  const outside = part.certifiedIn([west - 99, south - 99, middle.x, middle.y]);
  assert.equal(outside!.error, part.certifiedIn(window)!.error, 'what sticks out is no terrain');
  assert.equal(part.certifiedIn([west - 99, south, west - 9, north]), null);
  assert.equal(certifiedAt(certifiedOf(part.decoder), [{ x: east - 1, y: north - 1 }]), null);
  assert.deepEqual(certifiedAt(certifiedOf(part.decoder), [{ x: west + 1, y: south + 1 }]), part.decoder.certificate);
});

test('a signal ends opening and refining with its reason, and another call goes on', async () => {
  await assert.rejects(from(bytes, AbortSignal.abort()), { name: 'AbortError' });
  const opened = await from(trickled(bytes, 20000));
  const late = new AbortController();
  setTimeout(() => { late.abort(new Error('enough')); }, 50);
  await assert.rejects(opened.refined({ signal: late.signal }), /enough/);
  assert.ok(opened.mesh().indices.length > 3000, 'what came stays');
  const early = new AbortController();
  const patient = await from(bytes);
  await assert.rejects(async () => {
    for await (const _ of patient.refine({ signal: early.signal })) early.abort();
  }, { name: 'AbortError' });
  const two = patient.refine();
  await two.next();
  await assert.rejects(patient.refined(), /being refined already/);
  await two.return();
  assert.equal((await patient.refined()).state, 'complete');
});

test('damage is one clear error, wherever it is, and what came before stays', async () => {
  for (let i = 0; i < 12; ++i) {
    const damaged = new Uint8Array(bytes);
    damaged[Math.floor((i + 0.5) * bytes.length / 12)] ^= 1 << (i % 8);
    let opened: Terrain | null = null;
    await assert.rejects(async () => {
      opened = await from(damaged);
      await all(opened);
    }, (error: unknown) =>
      error instanceof DecodeError && /corruption|unsupported_version/.test(error.code) && /stream/.test(error.message));
    if (opened !== null) assert.ok((opened as Terrain).mesh().indices.length > 0);
  }
  await assert.rejects(from(new Uint8Array(0)), { name: 'Problem', title: 'The stream ends too early' });
  await assert.rejects(from(new TextEncoder().encode('<!doctype html><p>no stream at all')), { code: 'invalid_argument' });
});

test('a decoder that is something else, or not there, is a problem in a sentence', async () => {
  await assert.rejects(loadModule(new TextEncoder().encode('<!doctype html>')), { name: 'Problem', message: /no WebAssembly[^]*\{ wasm: url \}/ });
  await assert.rejects(loadModule('http://127.0.0.1:9/decoder.wasm'), { name: 'Problem', message: /127\.0\.0\.1:9\/decoder\.wasm/ });
  const half = readFileSync(join(assets, 'decoder.wasm')).subarray(0, 40000);
  await assert.rejects(loadModule(half), { name: 'Problem', message: /wasm-unsafe-eval/ });
  assert.equal(await loadModule(wasm), wasm);
});

test('of a service only what is missing travels, where it is wanted', () => served(`m=${store}`, async (address) => {
  const url = `${address}collections/m`;
  const opened = await openServed(url, { wasm });
  assert.deepEqual([opened.title, opened.heights], ['m', [633, 1576]]);
  const first = opened.bytes;
  const five = await opened.refined({ error: 5 });
  assert.equal(five.state, 'reached');
  assert.ok(five.certified!.error <= 5);
  assert.deepEqual(trianglesOfArrays(opened.mesh({ positions: 'map' })), refined(store, '--error', '5'));
  assert.equal((await opened.refined({ error: 5 })).bytes, opened.bytes, 'nothing is asked for twice');
  // A quarter of the terrain in detail; all of it stays as it was.
  const [west, south, east, north] = opened.bounds;
  const window = [west, south, (west + east) / 2, (south + north) / 2] as const;
  const part = await opened.refined({ error: 1, window });
  assert.ok(part.certified!.error <= 1 && part.certified!.window === window);
  assert.ok(opened.certifiedIn(opened.bounds)!.error > 1);
  const fromNothing = await openServed(url, { wasm });
  await fromNothing.refined({ error: 1 });
  assert.ok(opened.bytes - first < 0.6 * (fromNothing.bytes - first));
  const exact = await fromNothing.refined();
  assert.deepEqual([exact.state, exact.certified!.error, exact.positions.length / 3], ['complete', 0, 257 * 257]);
}));

test('of a service budgets and signals hold, and what it refuses is a problem', () => served(`m=${store}`, async (address) => {
  const opened = await openServed(new URL(`${address}collections/m`), { wasm });
  const budget = await opened.refined({ maxVertices: 9000 });
  assert.equal(budget.state, 'vertices');
  assert.ok(budget.positions.length <= 27000 && budget.positions.length > 20000);
  assert.equal((await opened.refined({ maxBytes: 5000 })).state, 'bytes');
  assert.ok(opened.bytes > budget.bytes, 'one frame always comes');
  const ended = new AbortController();
  await assert.rejects(async () => {
    for await (const _ of opened.refine({ signal: ended.signal, growth: 1 })) ended.abort();
  }, { name: 'AbortError' });
  await assert.rejects(opened.refined({ error: -1 }), (error: unknown) => error instanceof Problem && error.status === 400);
  assert.equal((await opened.refined({ error: 20 })).state, 'reached', 'another call goes on');
  await assert.rejects(openServed(`${address}collections/none`, { wasm }), (error: unknown) => error instanceof Problem && error.status === 404);
  await assert.rejects(openServed(`${address}healthz`, { wasm }), { name: 'Problem', title: 'This is no terrain service' });
}));

/** A service that a test plays: `answers` are given in turn, the last again and again. */
async function played(answers: Array<Uint8Array | 'break' | number>, use: (url: string, asked: string[]) => Promise<void>): Promise<void> {
  const asked: string[] = [];
  const { bounds, heights } = await from(bytes);
  const web = await host(folder, {
    answer: (request, response) => {
      if (request.method === 'GET') {
        response.end(JSON.stringify({ title: 'm', terrain: { bounds, heights } }));
        return true;
      }
      let body = '';
      request.on('data', (part: Buffer) => { body += part.toString(); });
      request.on('end', () => {
        const answer = answers[Math.min(asked.length, answers.length - 1)];
        asked.push(body);
        if (typeof answer === 'number') response.writeHead(answer).end();
        else if (answer === 'break') response.destroy();
        else response.writeHead(200).write(answer, () => { setTimeout(() => response.destroy(), 20); });
      });
      return true;
    },
  });
  try {
    await use(`${web.url}collections/m`, asked);
  } finally {
    await web.close();
  }
}

test('an answer of a service that breaks off anywhere is gone on from', async () => {
  const twenty = readFileSync(terrain('mountains_257', '--error', '20').stream);
  // Behind the head, within T0, and within a frame of splits.
  const begun = [20, 1000].map((cut) => played([twenty.subarray(0, cut), 503, twenty], async (url, asked) => {
    assert.ok((await openServed(url, { wasm })).mesh().indices.length > 0, `cut behind ${cut}`);
    assert.ok(!asked[2].includes('"have"'));
  }));
  const cut = played([twenty.subarray(0, twenty.length - 300), twenty], async (url, asked) => {
    const opened = await openServed(url, { wasm });
    assert.ok(opened.certifiedIn(opened.bounds)!.error < 100);
    await assert.rejects(opened.refined({ error: 5 }), (error: unknown) => error instanceof DecodeError);
    assert.match(asked[1], /"have":\[\{[^}]*"splits":[1-9]/, 'it goes on from what came');
  });
  const none = played(['break'], async (url, asked) => {
    await assert.rejects(openServed(url, { wasm }), { name: 'Problem', status: 0 });
    assert.equal(asked.length, 4, 'few tries');
  });
  await Promise.all([...begun, cut, none]);
});

test('an error that a service has no detail for was not reached', async () => {
  const { stream: all } = terrain('mountains_257', '--error', '20');
  ptin('stream', store, '--error', '20', '--have-error', '20', '-o', file('no_more.ptins'));
  await played([readFileSync(all), readFileSync(file('no_more.ptins'))], async (url) => {
    const step = await (await openServed(url, { wasm })).refined({ error: 5 });
    assert.ok(step.certified!.error > 5);
    assert.equal(step.state, 'complete');
  });
});

test('of a service damage is one clear error, too, and what came before stays', async () => {
  const damaged = new Uint8Array(bytes);
  damaged[20000] ^= 1;
  await played([readFileSync(terrain('mountains_257', '--error', '20').stream), damaged], async (url) => {
    const opened = await openServed(url, { wasm });
    const { length } = opened.mesh().indices;
    for (let i = 0; i < 2; ++i) await assert.rejects(opened.refined(), (error: unknown) => error instanceof DecodeError);
    assert.ok(opened.mesh().indices.length >= length);
  });
});

test('of a compound CRS the part of the map is found', () => {
  const map = 'PROJCRS["a, [b] ""c""",BASEGEOGCRS["d",ID["EPSG",4326]]]';
  assert.equal(mapCrsOf(`COMPOUNDCRS["x, y",${map},VERTCRS["z"]]`), map);
  assert.equal(mapCrsOf(map), map);
});
