// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain of a service, played by the program: only what is missing is asked for, within a budget of vertices.
import { certifiedAt, certifiedWithin, type Collection, Problem, type Serving, type StreamBody, type Wanted, widened, type Window } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import type { Frame } from '../src/frame';
import type { QuestionOf } from '../src/messages';
import type { Service } from '../src/service';
import { ServedView } from '../src/served_view';
import { decoderModule, file, gridded, ptin, terrain } from '../../decoder/test/support';

interface Asked extends Wanted {
  have: Serving[];
}

const { store } = terrain('mountains_257');
const info = JSON.parse(ptin('info', store, '--json')) as { bounds: { min_x: number; min_y: number; max_x: number; max_y: number } };
const bounds: Window = [info.bounds.min_x, info.bounds.min_y, info.bounds.max_x, info.bounds.max_y];
const collection: Collection = { title: 'm', bounds, heights: [633, 1576] };

/** The thing served: a store, and the most splits of an answer, or of one of so many bytes. */
interface Serves {
  path: string;
  collection: Collection;
  mostSplits?: number | ((bytes: number) => number);
  /** The terrain that the service tells of when it is asked again. */
  now?: Collection;
}

/** A view of a terrain, and what was asked for it. `refuses` may throw before an answer. */
function served(
  mostVertices: number, refuses: (asked: Asked, mostBytes: number) => void = () => undefined,
  { path, collection: about, mostSplits, now = about }: Serves = { path: store, collection },
): { view: ServedView; asked: Asked[]; faults: unknown[]; settled: () => Promise<void> } {
  const asked: Asked[] = [];
  const faults: unknown[] = [];
  let wake: (() => void) | null = null;
  const service = {
    collection: async (): Promise<Collection> => now,
    async stream({ window, error = 0, max_bytes, have = [] }: StreamBody): Promise<Response> {
      const wanted: Wanted = { window, error };
      asked.push({ ...wanted, have: have.map((h) => ({ ...h })) });
      refuses(asked[asked.length - 1], max_bytes);
      const more = have.length === 0 ? [] : ['--have', JSON.stringify(have)];
      const splits = typeof mostSplits === 'function' ? Math.floor(mostSplits(max_bytes)) : mostSplits;
      const most = splits === undefined ? [] : ['--splits', String(splits)];
      ptin('stream', path, '--error', String(wanted.error), '--window', ...wanted.window.map(String), ...more, ...most,
        '-o', file('served.ptins'), '--overwrite');
      return new Response(readFileSync(file('served.ptins')), { headers: { 'Ptin-Fingerprint': 'f', 'Server-Timing': 'compute;dur=10' } });
    },
  };
  const view = new ServedView(service as unknown as Service, about, decoderModule(), mostVertices, {
    grown: () => undefined, settled: () => { wake?.(); }, failed: (error) => { faults.push(error); }, mended: () => { faults.push('mended'); },
  });
  const settled = (): Promise<void> => new Promise((resolve) => { wake = resolve; });
  return { view, asked, faults, settled };
}

const middle = widened(bounds, bounds, -0.4);
const near: Wanted[] = [{ window: bounds, error: 20 }, { window: middle, error: 1 }];

test('a service that is busy is asked again when it wants to be, and nobody is troubled', async () => {
  const { view, asked, faults, settled } = served(1e6, () => {
    if (asked.length === 1) throw new Problem('The service is busy', 'Come again later.', 503);
  });
  void view.run();
  await settled();
  assert.equal(asked.length, 2);
  assert.deepEqual(faults, ['mended']);
  assert.ok(view.decoder.hasMesh);
});

test('a service that cannot be reached for a while is told of, asked again, and what was there stays', async () => {
  let down = false;
  const { view, asked, faults, settled } = served(1e6, () => {
    if (down) throw new Problem('The terrain cannot be reached', 'The connection to the host broke.');
  });
  void view.run();
  await settled();
  const before = asked.length, vertices = view.decoder.mesh.vertexCount;
  down = true;
  view.setView(near);
  setTimeout(() => { down = false; }, 500);
  await settled();
  assert.ok(faults[0] instanceof Problem);
  assert.deepEqual(faults.slice(1), ['mended']);
  assert.ok(asked.slice(before).every((a) => a.have.length > 0), 'it goes on from what there is');
  assert.ok(view.decoder.mesh.vertexCount > vertices);
});

test('each window keeps what it is certified for, however fine the last one is', async () => {
  const { view, settled } = served(1e6);
  void view.run();
  await settled();
  view.setView(near);
  await settled();
  assert.ok(view.decoder.certificate!.error <= 1, 'of the last window');
  const told = (at: { x: number; y: number }): number => certifiedAt(view.certified, [at])!.error;
  const inside = { x: (middle[0] + middle[2]) / 2, y: (middle[1] + middle[3]) / 2 };
  const aside = { x: bounds[0] + 1, y: bounds[1] + 1 };
  assert.ok(told(inside) <= 1);
  assert.ok(told(aside) > 1 && told(aside) <= 20);
});

test('detail comes where the camera looks, once', async () => {
  const { view, asked, faults, settled } = served(1e6);
  void view.run();
  await settled();
  const first = view.decoder.mesh.vertexCount;
  assert.equal(asked.length, 1);
  assert.deepEqual(asked[0].have, []);
  view.setView(near);
  await settled();
  assert.ok(view.decoder.mesh.vertexCount > first + 1000);
  const requests = asked.length;
  assert.equal(asked[requests - 1].have.length, requests - 1, 'what was served is told');
  assert.ok(view.decoder.certificate!.error <= 1);
  view.setView(near);
  await settled();
  view.setView([near[0], { window: middle, error: 1.1 }]);
  await settled();
  assert.equal(asked.length, requests, 'nothing is asked for twice');
  assert.equal(view.progress.heldBy, undefined);
  assert.deepEqual(faults, []);
});

test('a window that sticks out by the last bit of a number is covered', async () => {
  const { view, asked, settled } = served(1e6);
  void view.run();
  await settled();
  view.setView([{ window: [bounds[0] - 1e-9, bounds[1], bounds[2] + 1e-9, bounds[3]], error: 20 }]);
  await settled();
  assert.ok(asked.length <= 2);
});

test('the budget of vertices is kept: by leaving what is not looked at, then by larger errors', async () => {
  const { view, asked, settled } = served(9000);
  void view.run();
  await settled();
  const corner = (i: number, j: number): Window => {
    const [x, y] = [(bounds[2] - bounds[0]) / 4, (bounds[3] - bounds[1]) / 4];
    return [bounds[0] + i * x, bounds[1] + j * y, bounds[0] + (i + 1) * x, bounds[1] + (j + 1) * y];
  };
  for (const [i, j] of [[0, 0], [3, 0], [3, 3], [0, 3]]) {
    view.setView([{ window: bounds, error: 40 }, { window: corner(i, j), error: 1.5 }]);
    await settled();
    assert.ok(view.decoder.mesh.vertexCount <= 9000, `${view.decoder.mesh.vertexCount} vertices`);
  }
  // Places beside the parts are certified, too, after a start anew.
  view.setView([{ window: corner(1, 1), error: 1 }]);
  await settled();
  view.setView([{ window: corner(2, 1), error: 0.3 }]);
  await settled();
  const anew = asked.map((a) => a.have.length).lastIndexOf(0);
  assert.ok(anew > 0 && certifiedWithin(view.certified, bounds) !== null);
  assert.ok(asked.some((a, i) => i > 0 && a.have.length === 0), 'a view was fetched anew');
  view.setView([{ window: bounds, error: 0.5 }]);
  await settled();
  assert.ok(view.decoder.mesh.vertexCount <= 9000);
  assert.equal(view.progress.heldBy, 'vertices');
});

/** As a service that keeps to the bytes of an answer. */
const byBytes: Serves = { path: store, collection, mostSplits: (bytes) => bytes / 4 };

test('where all is looked at and there is no room for more, what came stays, and a small move asks for nothing', async () => {
  const { view, asked, settled } = served(40000, () => undefined, byBytes);
  void view.run();
  await settled();
  view.setView([{ window: bounds, error: 0.05 }]);
  await settled();
  const held = view.decoder.mesh.vertexCount;
  assert.ok(held > 0.8 * 40000 && held <= 40000, `${held} vertices`);
  assert.ok(asked.slice(1).every((a) => a.have.length > 0), 'nothing was fetched anew');
  assert.equal(view.progress.heldBy, 'vertices');
  const requests = asked.length;
  view.setView([{ window: widened(bounds, bounds, -0.02), error: 0.05 }]);
  await settled();
  assert.equal(asked.length, requests);
});

test('who looks at a fifth of a full view gets more detail there, in parts that lie in one another, too', async () => {
  const { view, settled } = served(30000, () => undefined, byBytes);
  void view.run();
  await settled();
  view.setView([{ window: bounds, error: 0.05 }]);
  await settled();
  const at = { x: (bounds[0] + bounds[2]) / 2, y: (bounds[1] + bounds[3]) / 2 };
  const before = certifiedAt(view.certified, [at])!.error;
  view.setView([-0.27, -0.28, -0.29, -0.3].map((share) => ({ window: widened(bounds, bounds, share), error: 0.05 })));
  await settled();
  assert.ok(certifiedAt(view.certified, [at])!.error < before, `${certifiedAt(view.certified, [at])!.error} after ${before}`);
});

test('who comes back from a near view sees as much as before', async () => {
  const { view, settled } = served(30000, () => undefined, byBytes);
  void view.run();
  await settled();
  const home: Wanted[] = [{ window: bounds, error: 0.8 }];
  view.setView(home);
  await settled();
  const before = certifiedWithin(view.certified, bounds)!.error;
  for (const error of [0.4, 0.1, 0.02]) {
    view.setView([{ window: widened(bounds, bounds, -0.35), error }]);
    await settled();
  }
  view.setView(home);
  await settled();
  const after = certifiedWithin(view.certified, bounds)!.error;
  assert.ok(after <= 1.3 * before, `${after} after ${before}`);
});

test('where there is room for less than is wanted, parts are about as fine as one another', async () => {
  const { view, settled } = served(30000, () => undefined, byBytes);
  void view.run();
  await settled();
  const half = (bounds[0] + bounds[2]) / 2;
  const wanted: Wanted[] = [{ window: [bounds[0], bounds[1], half, bounds[3]], error: 0.05 }, { window: [half, bounds[1], bounds[2], bounds[3]], error: 0.2 }];
  view.setView(wanted);
  await settled();
  const times = wanted.map(({ window: [west, south, east, north], error }) =>
    certifiedAt(view.certified, [{ x: west, y: south }, { x: east, y: north }])!.error / error);
  assert.ok(Math.max(...times) > 2, 'there is too little room');
  assert.ok(Math.max(...times) <= 4 * Math.min(...times), `${times}`);
  assert.ok(view.decoder.mesh.vertexCount <= 30000);
});

test('refusals are mended: a replaced file begins anew, too much becomes less', async () => {
  let replaced = true;
  const { view, asked, faults, settled } = served(1e6, (a) => {
    if (a.have.length !== 0 && replaced) {
      replaced = false;
      throw new Problem('Conflict', 'the file was replaced', 409);
    }
    if (a.error < 2) throw new Problem('Too much', 'the answer takes more memory', 413, 'question_memory');
  });
  void view.run();
  await settled();
  view.setView([{ window: bounds, error: 5 }]);
  await settled();
  assert.ok(asked.some((a, i) => i > 1 && a.have.length === 0));
  assert.ok(view.decoder.certificate!.error <= 5);
  view.setView([{ window: bounds, error: 5 }, { window: middle, error: 1 }]);
  await settled();
  assert.equal(view.progress.heldBy, 'service');
  assert.deepEqual(faults, []);
});

test('a terrain that another one took the place of is told to be so, and nothing of the other is drawn', async () => {
  for (const status of [400, 409]) {
    const { view, asked, settled } = served(1e6, (a) => {
      if (a.have.length !== 0) throw new Problem('Refused', 'this misses the terrain, or it was replaced', status);
    }, { path: store, collection, now: { ...collection, bounds: [0, 0, 1, 1] } });
    const ended = view.run();
    await settled();
    const before = asked.length;
    view.setView([{ window: bounds, error: 5 }]);
    await assert.rejects(ended, /another one under this name now; reload the page/);
    assert.equal(asked.length, before + 1);
  }
});

/** A terrain with voids of a sample each, whose borders come in several answers: before no error is finite. */
function holed(mostSplits: number): Serves {
  const heights = Array.from({ length: 90 }, (_, row) => Array.from({ length: 90 }, (_, c) =>
    (row % 3 === 1 && c % 3 === 1 ? '-9999' : (400 + 200 * Math.sin(c / 14) * Math.cos(row / 11)).toFixed(2))));
  const { store: path } = gridded('holed', 'EPSG:32632', [400000, 5000000], 10, heights);
  const around: Window = [400005, 5000005, 400895, 5000895];
  return { path, collection: { title: 'h', bounds: around, heights: [200, 600], limits: { computing: 10000 } }, mostSplits };
}

test('of many voids all borders come, answer by answer, until an error is certified', async () => {
  const serves = holed(400);
  const { view, asked, faults, settled } = served(1e6, () => undefined, serves);
  void view.run();
  await settled();
  assert.equal(view.decoder.certificate!.error, Infinity, 'the first answer certifies nothing');
  view.setView([{ window: serves.collection.bounds, error: 5 }]);
  await settled();
  assert.ok(asked.length > 3);
  assert.ok(asked.every((a) => Number.isFinite(a.error)), 'a service is asked for numbers');
  assert.ok(view.decoder.certificate!.error <= 5);
  assert.deepEqual(faults, []);
});

test('where the borders of voids alone are nearly too many, or are, there is an end of asking', async () => {
  for (const [budget, mostSplits, isCertified] of [[500, 200, false], [1200, 600, true]] as const) {
    const serves = holed(mostSplits);
    const { view, asked, faults, settled } = served(budget, () => undefined, serves);
    void view.run();
    await settled();
    view.setView([{ window: serves.collection.bounds, error: 5 }]);
    await settled();
    assert.equal(view.progress.state, 'held');
    assert.equal(view.decoder.certificate!.error < Infinity, isCertified);
    assert.equal(view.decoder.mesh.vertexCount <= budget, isCertified);
    assert.ok(asked.length < 25, `${asked.length} requests`);
    assert.deepEqual(faults, []);
  }
});

test('of a service that has no /volume an area is told in plan, and whatever else it refuses stays refused', async () => {
  const refusing = (status: number): ServedView => new ServedView(
    { answer: async () => { throw new Problem('Refused', 'refused by the service', status); } } as unknown as Service, collection, decoderModule(), 1e6,
    { grown: () => undefined, settled: () => undefined, failed: () => undefined, mended: () => undefined },
  );
  const frame = (isDegrees: boolean): Frame => ({ isDegrees, earth: { lengths: { unit: 'metre', metres: 1 } } }) as unknown as Frame;
  const question: QuestionOf<'area'> = { kind: 'area', ring: [{ x: 9, y: 1 }, { x: 9, y: 4 }, { x: 5, y: 4 }], against: 0 };
  const told = await refusing(404).answer(question, frame(false)) as { measured: object };
  assert.deepEqual(told.measured, { surface: 6, empty: 0, cut: null, fill: null, unit: 'metre' });
  await assert.rejects(refusing(404).answer(question, frame(true)), /has \/volume/);
  await assert.rejects(refusing(413).answer(question, frame(false)), /refused by the service/);
  await assert.rejects(refusing(404).answer({ kind: 'height', at: { x: 0, y: 0 } }, frame(false)), /refused by the service/);
});
