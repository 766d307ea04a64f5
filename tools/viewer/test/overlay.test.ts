// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels over the picture, questions of links and files, and questions to a service within its limits.
import { type Collection, type Problem, type StreamBody, type Wanted, type Window } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import type { Frame } from '../src/frame';
import { apart, contourLabels, indexContours, type Label } from '../src/labels';
import { lineInFile } from '../src/lines_in_file';
import { Peaks, squaresIn } from '../src/peaks';
import { askedInHash, askedToHash } from '../src/permalink';
import type { Place } from '../src/relief';
import { classOf } from '../src/seen';
import type { Service } from '../src/service';
import { ServedView } from '../src/served_view';
import { joined } from '../src/stations';
import { addressOf } from '../src/terrain_element';
import { decoderModule, file, ptin, terrain } from '../../decoder/test/support';

/** A scene in the heights' own unit. */
const frame = { heightAt: (z: number) => z, sceneZ: (h: number) => h } as Frame;
/** From straight above, a pixel a metre, north up. */
const above = ({ x, y }: Place): { x: number; y: number; visible: boolean } =>
  ({ x, y: 400 - y, visible: x > 0 && x < 600 && y > 0 && y < 400 });

/** A plane that rises by `rise` a metre towards (east, north). */
function plane(east: number, north: number): { positions: Float32Array; corners: Uint32Array } {
  const positions: number[] = [], corners: number[] = [];
  for (let r = 0; r <= 40; ++r) for (let c = 0; c <= 60; ++c) positions.push(10 * c, 10 * r, 0.3 * (east * 10 * c + north * 10 * r) + 0.01);
  for (let r = 0; r < 40; ++r) {
    for (let c = 0; c < 60; ++c) {
      const a = 61 * r + c;
      corners.push(a, a + 1, a + 61, a + 1, a + 62, a + 61);
    }
  }
  return { positions: Float32Array.from(positions), corners: Uint32Array.from(corners) };
}

test('labels stand on index contours, follow them, and their heads are uphill', () => {
  for (const [east, north, angle] of [[0, 1, 0], [0, -1, Math.PI], [1, 0, Math.PI / 2], [-1, 0, -Math.PI / 2]] as const) {
    const pieces = indexContours(plane(east, north), frame, 4);
    assert.ok(pieces.length > 100);
    for (const p of pieces) assert.equal(Math.abs(p.height % 20), 0);
    const labels = contourLabels(pieces, above, { width: 600, height: 400 }, 'm');
    assert.ok(labels.length >= 4, `${labels.length} labels`);
    for (const l of labels) {
      assert.ok(Math.hypot(Math.sin(l.angle) - Math.sin(angle), Math.cos(l.angle) - Math.cos(angle)) < 0.02, `${l.angle}, not ${angle}`);
      assert.ok(Math.abs(Number(l.text.replace(/[^0-9]/g, '')) - Math.abs(0.3 * (east * l.x + north * (400 - l.y)))) < 1, l.text);
    }
  }
});

test('labels keep apart, in the picture and off its panels', () => {
  const label = (x: number, y: number, kind: Label['kind'] = 'contour'): Label => ({ x, y, angle: 0, text: '100 m', kind, of: { x, y, z: 0 } });
  const size = { width: 300, height: 200 };
  const places = (labels: Label[], panels: Parameters<typeof apart>[2] = []): number[][] => apart(labels, size, panels).map((l) => [l.x, l.y]);
  assert.deepEqual(places([label(100, 100), label(120, 105), label(160, 100), label(100, 120)]), [[100, 100], [160, 100], [100, 120]]);
  assert.deepEqual(places([label(10, 100), label(290, 100), label(100, 5), label(100, 195), label(100, 20, 'peak'), label(100, 30, 'peak')]), [[100, 30]]);
  const panel = { x: 250, y: 100, w: 50, h: 80 };
  assert.deepEqual(places([label(190, 100), label(170, 100), label(250, 190)], [panel]), [[170, 100], [250, 190]]);
});

test('peaks are asked for once a square, and nearer ones of smaller squares', async () => {
  const bounds: Window = [0, 0, 800, 400];
  assert.equal(squaresIn(bounds, bounds).size, 16);
  const near = squaresIn([100, 100, 200, 150], bounds);
  assert.ok(near.size >= 4 && near.size <= 25);
  for (const [w, s, e, n] of near.values()) assert.ok(e > 100 && w < 200 && n > 100 && s < 150);
  let asked = 0;
  const peaks = new Peaks((window) => {
    ++asked;
    return window[0] === 0 ? Promise.reject(new Error('busy')) : Promise.resolve({ x: window[0] + 1, y: window[1] + 1, height: 7 });
  });
  assert.equal((await peaks.within([bounds], bounds)).length, 12);
  assert.equal((await peaks.within([bounds], bounds)).length, 12);
  assert.equal(asked, 16);
  const both = await peaks.within([bounds, [400, 200, 500, 250]], bounds);
  assert.ok(both.length > 12 && both.length < 12 + asked - 16, 'a corner of a small square is that of a large one, and comes once');
});

test('links ask what was asked', () => {
  const asked = { tool: 'sight' as const, places: [{ x: -118.25, y: 34.5 }, { x: 1e6, y: 0 }], values: [2, 30, 0.45] };
  assert.deepEqual(askedInHash(`#at=1${askedToHash(asked)}`), asked);
  assert.equal(askedToHash(null), '');
  for (const bad of ['', '#ask=dig:1,2', '#ask=height:1', '#ask=height:a,b']) assert.equal(askedInHash(bad), null);
});

test('files hold lines, or are refused with a sentence', () => {
  const gpx = '<gpx><trk><trkseg><trkpt lat="34.5" lon="-118.1"><ele>3</ele></trkpt><trkpt lon="-118.2" lat="34.6"/></trkseg></trk></gpx>';
  assert.deepEqual(lineInFile('a.gpx', gpx), { line: [{ x: -118.1, y: 34.5 }, { x: -118.2, y: 34.6 }], isLonLat: true });
  const json = { type: 'FeatureCollection', features: [{ type: 'Feature', geometry: { type: 'LineString', coordinates: [[1, 2, 9], [3, 4], [3, 4]] } }] };
  assert.deepEqual(lineInFile('a.geojson', JSON.stringify(json)).line, [{ x: 1, y: 2 }, { x: 3, y: 4 }]);
  assert.deepEqual(lineInFile('a.csv', 'name;latitude;longitude\na;1;2\nb;3;4\n'), { line: [{ x: 2, y: 1 }, { x: 4, y: 3 }], isLonLat: true });
  assert.deepEqual(lineInFile('a.csv', '5,6\n7,8'), { line: [{ x: 5, y: 6 }, { x: 7, y: 8 }], isLonLat: false });
  const long = Array.from({ length: 5000 }, (_, i) => `${i},${i}`).join('\n');
  const { line } = lineInFile('long.csv', long);
  assert.ok(line.length <= 400 && line[line.length - 1].x === 4999);
  for (const [name, text] of [['a.csv', 'x,y\n1,2'], ['a.gpx', '<gpx/>'], ['a.json', '{'], ['a.csv', 'x,y\n1,2\n,3']]) {
    assert.throws(() => lineInFile(name, text), (error: Problem) => error.message.length > 10);
  }
});

test('profiles of several legs are one', () => {
  const leg = (a: number, b: number | null) => ({ length: 10, stations: [{ distance: 0, x: 0, y: 0, height: a }, { distance: b === null ? 4 : 10, x: 1, y: 0, height: b }] });
  assert.deepEqual(joined([leg(1, 2), leg(2, 3)]).stations.map((s) => [s.distance, s.height]), [[0, 1], [10, 2], [20, 3]]);
  assert.deepEqual(joined([leg(1, null), leg(5, 6)]).stations.map((s) => [s.distance, s.height]), [[0, 1], [4, null], [10, 5], [20, 6]]);
  assert.equal(joined([leg(1, 2), leg(2, 3)]).length, 20);
});

test('the colours of a viewshed are told by the class of the pixel', () => {
  assert.deepEqual([classOf(46, 158, 176), classOf(200, 177, 176), classOf(107, 90, 128), classOf(48, 48, 128), classOf(0, 0, 0)],
    ['seen', 'perhaps', 'perhaps', 'unseen', null]);
});

test('an element opens terrains of services, below a path too, and streams', () => {
  const viewer = 'https://v.org/viewer/', page = 'https://p.org/a/b.html';
  assert.equal(addressOf('https://s.org/x/collections/alps', '', viewer, page),
    'https://v.org/viewer/index.html?service=https%3A%2F%2Fs.org%2Fx&collection=alps&embed=1');
  assert.equal(addressOf('dem.ptins', '#shading=slope', viewer, page),
    'https://v.org/viewer/index.html?stream=https%3A%2F%2Fp.org%2Fa%2Fdem.ptins&embed=1#shading=slope');
});

test('a service is asked within its limits: no more is held than it goes on from, and no answer is much finer than what is there', async () => {
  const { store } = terrain('mountains_257');
  const { bounds: b } = JSON.parse(ptin('info', store, '--json')) as { bounds: { min_x: number; min_y: number; max_x: number; max_y: number } };
  const bounds: Window = [b.min_x, b.min_y, b.max_x, b.max_y];
  const limits = { held_vertices: 11000, computing: 1000 };
  const collection: Collection = { title: 'm', bounds, heights: [633, 1576], limits };
  const asked: StreamBody[] = [];
  const service = {
    async stream(body: StreamBody): Promise<Response> {
      const have = body.have ?? [];
      asked.push({ ...body, have: have.map((h) => ({ ...h })) });
      const more = have.length === 0 ? [] : ['--have', JSON.stringify(have)];
      ptin('stream', store, '--error', String(body.error), '--window', ...body.window.map(String), ...more, '-o', file('limits.ptins'), '--overwrite');
      // An answer takes the longer the finer it is.
      const took = 10 + 2000 / (body.error ?? 1);
      return new Response(readFileSync(file('limits.ptins')), { headers: { 'Ptin-Fingerprint': 'f', 'Server-Timing': `query;dur=${took}` } });
    },
  };
  let wake = (): void => undefined;
  const view = new ServedView(service as unknown as Service, collection, decoderModule(), 1e6, {
    grown: () => undefined, settled: () => { wake(); }, failed: (error) => { throw error; }, mended: () => undefined,
  });
  const settled = (): Promise<void> => new Promise((resolve) => { wake = resolve; });
  void view.run();
  await settled();
  const wanted: Wanted = { window: bounds, error: 1 };
  view.setView([wanted]);
  await settled();
  for (let i = 1; i < asked.length; ++i) {
    const held = asked[i].have!.reduce((n, h) => n + h.splits, 0);
    assert.ok(held <= 0.9 * limits.held_vertices, `${held} are held`);
    if (asked[i].have!.length > 0) assert.ok(asked[i].error! > asked[i - 1].error! / 7, `${asked[i - 1].error} then ${asked[i].error}`);
  }
  assert.ok(asked.length > 3);
  assert.equal(view.progress.heldBy, 'service', 'and what is missing is told');
});
