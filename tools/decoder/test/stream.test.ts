// SPDX-License-Identifier: GPL-3.0-or-later
//
// Streams from every kind of source, as far as they are wanted; and terrains of a service.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import {
  type Decoder, DecodeError, ServedTerrain, ServiceError, boundsOf, certifiedAt, certifiedOf, decodeStream, surfaceAround, surfaceOf, toldBy,
} from '../src/index';
import { host } from './host.mjs';
import { decoded, decoderModule, file, folder, made, ptin, served, terrain, trianglesOf, trianglesOfPly } from './support';

const module = decoderModule();
const { store, stream } = terrain('mountains_257', '--error', '0.5');
const bytes = new Uint8Array(readFileSync(stream));

async function last(steps: AsyncIterable<Decoder>): Promise<Decoder> {
  let decoder: Decoder | null = null;
  for await (decoder of steps);
  assert.ok(decoder !== null);
  return decoder;
}

function* pieces(size: number): Generator<Uint8Array> {
  for (let at = 0; at < bytes.length; at += size) yield bytes.subarray(at, at + size);
}

test('any source gives the same mesh', async () => {
  const wanted = trianglesOf(decoded(module, bytes).mesh, decoded(module, bytes).facts);
  const site = await host(folder);
  try {
    const sources = [
      bytes, bytes.slice().buffer, new Response(bytes), new Blob([bytes]).stream(), pieces(1000),
      `${site.url}${encodeURIComponent(stream.slice(folder.length + 1))}`,
    ];
    for (const source of sources) {
      const decoder = await last(decodeStream(module, source));
      assert.ok(decoder.isComplete);
      assert.deepEqual(trianglesOf(decoder.mesh, decoder.facts), wanted);
    }
    await assert.rejects(last(decodeStream(module, `${site.url}none.ptins`)), /none\.ptins answered 404/);
  } finally {
    await site.close();
  }
});

test('each step is finer than the one before, and what is yielded is certified', async () => {
  let error = Infinity, vertices = 0, steps = 0;
  for await (const decoder of decodeStream(module, pieces(3000), { every: 0 })) {
    assert.ok(decoder.certificate.error <= error && decoder.mesh.vertexCount >= vertices);
    ({ error } = decoder.certificate);
    vertices = decoder.mesh.vertexCount;
    ++steps;
  }
  assert.ok(steps > 10);
  assert.ok(error <= 0.5);
});

test('an error, a number of vertices and an abort end it', async () => {
  const decoder = await last(decodeStream(module, pieces(100), { error: 20 }));
  assert.ok(!decoder.isComplete && decoder.certificate.error <= 20 && decoder.certificate.error > 5);
  const few = await last(decodeStream(module, bytes, { mostVertices: 2000 }));
  assert.ok(few.mesh.vertexCount <= 2000 && few.mesh.vertexCount > 1500, String(few.mesh.vertexCount));
  const abort = new AbortController();
  let steps = 0;
  await assert.rejects(async () => {
    for await (const step of decodeStream(module, pieces(100), { every: 0, signal: abort.signal })) {
      assert.ok(step.hasMesh);
      if (++steps === 3) abort.abort();
    }
  }, { name: 'AbortError' });
  assert.equal(steps, 3);
});

test('leaving the loop lets go of the source, and a broken connection leaves what came', async () => {
  let cancelled = false, sent = 0;
  const endless = (): ReadableStream<Uint8Array> => new ReadableStream({
    pull: (to) => {
      to.enqueue(bytes.subarray(sent, sent += 500));
      if (sent > bytes.length / 2) to.error(new Error('the connection broke'));
    },
    cancel: () => { cancelled = true; },
  });
  for await (const _ of decodeStream(module, endless(), { every: 0 })) break;
  assert.ok(cancelled);
  sent = 0;
  const decoder = await last(decodeStream(module, endless()));
  assert.ok(decoder.hasMesh && !decoder.isComplete);
});

test('damage is one error, and nothing at all is told apart', async () => {
  const damaged = bytes.slice();
  damaged[damaged.length >> 1] ^= 4;
  await assert.rejects(last(decodeStream(module, damaged)), (e: unknown) => e instanceof DecodeError && e.code === 'corruption');
  await assert.rejects(last(decodeStream(module, bytes.subarray(0, 100))), /ends before its first mesh/);
});

test('the surface is what the program writes, and leaves voids open', () => {
  const { store: voids, stream: withVoids } = made('voids');
  ptin('refine', voids, '-o', file('voids.ply'), '--overwrite');
  const decoder = decoded(module, readFileSync(withVoids));
  const { positions, indices } = surfaceOf(decoder);
  const rows = Array.from({ length: indices.length / 3 }, (_, t) => {
    const corners = [0, 1, 2].map((i) => Array.from(positions.subarray(3 * indices[3 * t + i], 3 * indices[3 * t + i] + 3)));
    const [[ax, ay], [bx, by], [cx, cy]] = corners;
    assert.ok((bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0, 'counter-clockwise');
    const names = corners.map((c) => c.join(' '));
    const first = names.indexOf([...names].sort()[0]);
    return [0, 1, 2].map((i) => names[(first + i) % 3]).join(', ');
  });
  assert.deepEqual(rows.sort(), trianglesOfPly(file('voids.ply')));
  const [west, south] = boundsOf(decoder.facts);
  const around = surfaceAround(decoder, [west, south, 600]);
  around.positions.forEach((p, i) => {
    const wanted = positions[i] - [west, south, 600][i % 3];
    assert.ok(Number.isNaN(wanted) ? Number.isNaN(p) : p === Math.fround(wanted));
  });
});

test('where nothing is known the certificate says so', () => {
  const line = terrain('mountains_257', '--level', '1000').stream;
  const decoder = decoded(module, readFileSync(line));
  const [west, south, east, north] = boundsOf(decoder.facts);
  const middle = { x: (west + east) / 2, y: (south + north) / 2 };
  assert.deepEqual(certifiedAt(certifiedOf(decoder), [middle]), decoder.certificateByRelief);
  const all = decoded(module, bytes);
  assert.deepEqual(certifiedAt(certifiedOf(all), [middle]), all.certificate);
  assert.deepEqual(certifiedAt(certifiedOf(all), [{ x: west - 1, y: south }]), all.certificateByRelief);
  assert.match(toldBy(all.metadata).crs, /UTM zone 11N/);
});

test('a served terrain is refined where it is wanted, and asks for nothing twice', async () => {
  await served(`t=${store}`, async (address) => {
    const at = `${address}collections/t`;
    const map = new ServedTerrain(module, at);
    const [west, south, east, north] = boundsOf(decoded(module, bytes).facts);
    await map.refine({ window: [west, south, east, north], error: 30 });
    const coarse = map.decoder.mesh.vertexCount;
    let grown = 0;
    const corner = { window: [west, south, west + (east - west) / 4, south + (north - south) / 4] as const, error: 1 };
    await map.refine(corner, { mostBytes: 4096, grown: () => { ++grown; } });
    assert.ok(grown > 2 && map.decoder.mesh.vertexCount > coarse);
    assert.ok(certifiedAt(map.certified, [{ x: west + 100, y: south + 100 }]).error <= 1);
    const beyond = certifiedAt(map.certified, [{ x: east - 100, y: north - 100 }]).error;
    assert.ok(beyond <= 30 && beyond > 1);
    const { version } = map.decoder;
    await map.refine(corner);
    assert.equal(map.decoder.version, version);
    await assert.rejects(map.refine({ ...corner, error: -1 }), (e: unknown) => e instanceof ServiceError && e.status === 400);
    await assert.rejects(map.refine({ ...corner, error: 0.1 }, { signal: AbortSignal.abort() }), { name: 'AbortError' });
    await assert.rejects(new ServedTerrain(module, `${address}collections/no`).refine(corner), { status: 404 });
  });
});
