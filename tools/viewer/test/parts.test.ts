// SPDX-License-Identifier: GPL-3.0-or-later
//
// The small parts: numbers for people, permalinks, CSV, kept bytes, windows, frames of degrees, costs.
import { certifiedAt, type CertifiedPart, certifiedWithin, type Facts, HostedBytes, none, toldBy, widened, type Window } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { type DrawnMesh, drawnMesh, edgesOf, surfaceEnd } from '../src/drawn_mesh';
import { earthOf, scaleAt } from '../src/earth';
import { bound, bytes, coordinates, count, height, interval, length, metres, number, roundBelow } from '../src/format';
import { FileView } from '../src/file_view';
import { Frame } from '../src/frame';
import { nameOf, treeOf, treeRow } from '../src/map_tiles';
import { defaults, fromHash, toHash } from '../src/permalink';
import { csvOf } from '../src/plot';
import { certaintyOf, costOf } from '../src/service';
import { heightAlong, runsOf } from '../src/stations';
import { KeptBytes, StaticStream } from '../src/static_stream';
import { Ground } from '../src/triangle_grid';
import { kindsOf, land, water } from '../src/water';
import { host } from '../../decoder/test/host.mjs';
import { decoded, decoderModule, gridded, terrain } from '../../decoder/test/support';

test('numbers', () => {
  assert.equal(number(0.0123456, 3), '0.0123');
  assert.equal(number(-12345.6, 3), '\u221212\u202f346');
  assert.equal(count(1234567), '1\u202f234\u202f567');
  assert.equal(bytes(1289341), '1.29 MB');
  assert.equal(metres(950), '950 m');
  assert.equal(metres(12346), '12.35 km');
  assert.equal(height(907.123, 13.3, 'm'), '907 m');
  assert.equal(height(907.123, 0, 'm'), '907.12 m');
  assert.equal(coordinates(-118.25, -34.5, true), '34.50000° S  118.25000° W');
  assert.equal(coordinates(181.25, -16, true), '16.00000° S  178.75000° W', 'across the antimeridian');
  assert.equal(roundBelow(730), 500);
  assert.equal(roundBelow(0.2), 0.2);
});

test('a bound is never told smaller, nor an interval narrower, than it is', () => {
  assert.equal(bound(0.8501), '0.851');
  assert.equal(bound(0.85), '0.850');
  assert.equal(bound(12341), '12\u202f400');
  assert.equal(bound(0), '0');
  assert.deepEqual(interval(907.11, 913.66, 'm'), ['907.1 m', '913.7 m']);
  assert.deepEqual(interval(-0.016, 0.009, 'ft'), ['\u22120.016 ft', '0.009 ft']);
});

test('a length of no known unit is told in map units', () => {
  assert.equal(length(2500, { unit: 'foot', metres: 0.3048 }), '762 m');
  assert.equal(length(2500, { unit: 'unknown', metres: null }), '2500 map units');
});

test('what is certified in sight is the worst of it, and of a place the best that is known', () => {
  const part = (window: Window, error: number): CertifiedPart => ({ window, error, deviation: 3 * error });
  const bounds: Window = [0, 0, 100, 100];
  const certified = [part(bounds, 20), part([0, 0, 50, 50], 5), part([10, 10, 30.000000000001, 30], 1), part([30, 10, 40, 30], 1)];
  const sees = (view: Window) => (w: Window): boolean => w[0] < view[2] && w[2] > view[0] && w[1] < view[3] && w[3] > view[1];
  const within = (...view: [number, number, number, number]): number => certifiedWithin(certified, bounds, sees(view))!.error;
  assert.equal(within(12, 12, 28, 28), 1);
  assert.equal(within(12, 12, 38, 28), 1, 'two windows cover it together');
  assert.equal(within(12, 12, 42, 28), 5);
  assert.equal(within(5, 5, 60, 20), 20);
  assert.equal(certifiedWithin(certified, bounds, sees([12, 12, 42, 28]))?.deviation, 15);
  assert.equal(certifiedWithin(certified, bounds, () => false)?.error, 20, 'nothing in sight: all of it');
  assert.equal(certifiedWithin(certified.slice(1), bounds, sees([60, 60, 70, 70])), null, 'of a part nothing is known');
  assert.equal(certifiedWithin([], bounds, () => false), null);
  assert.equal(certifiedAt(certified.slice(1), [{ x: 60, y: 60 }]), null);
  assert.equal(certifiedAt(certified, [{ x: 20, y: 20 }, { x: 35, y: 20 }])?.error, 5, 'a line needs one window');
  assert.equal(certifiedAt(certified, [{ x: 20, y: 20 }])?.error, 1);
});

test('a permalink brings back what it was made of', () => {
  const pose = { x: 379901.25, y: 3803354.5, height: 907, distance: 8123, heading: 340, tilt: 52 };
  const settings = { ...defaults, shading: 'slope' as const, wireframe: true, interval: 20, exaggeration: 1.5, error: 2.5 };
  const back = fromHash(`#${toHash(pose, settings)}`);
  assert.deepEqual(back, { pose, settings });
  assert.deepEqual(fromHash(''), { pose: null, settings: defaults });
  assert.deepEqual(fromHash('#at=1,2,x&shading=no&exaggeration=99&interval=-3'), { pose: null, settings: defaults });
});

test('a profile as CSV, with its gaps, as its points came', () => {
  const stations = [{ distance: 0, x: 0, y: 0, height: 5 }, { distance: 10, x: 11, y: 5, height: 7 },
    { distance: 10, x: 11, y: 5, height: null }, { distance: 15, x: 15, y: 7.5, height: 6 }, { distance: 20, x: 20, y: 10, height: 8 }];
  const profile = { stations, length: 20, lengths: { unit: 'metre', metres: 1 } };
  assert.equal(csvOf(profile, 0.5),
    'distance_m,x,y,height,height_min,height_max\n0,0,0,5,4.5,5.5\n10,11,5,7,6.5,7.5\n10,11,5,,,\n' +
    '15,15,7.5,6,5.5,6.5\n20,20,10,8,7.5,8.5\n');
  assert.match(csvOf({ ...profile, lengths: { unit: 'US survey foot', metres: 0.3048 } }, 0), /^distance_US_survey_foot,x/);
  assert.match(csvOf(profile, null), /\n0,0,0,5,,\n/, 'what is not known is not told');
  assert.equal(runsOf(stations).length, 2);
  assert.equal(heightAlong(stations, 5), 6);
  assert.equal(heightAlong(stations, 12), null);
});

test('bytes are kept in order and can be read again', () => {
  const kept = new KeptBytes();
  kept.add(Uint8Array.of(1, 2, 3));
  kept.add(Uint8Array.of());
  kept.add(Uint8Array.of(4));
  kept.pass(2);
  assert.deepEqual([...kept.next()!], [3]);
  kept.pass(1);
  assert.deepEqual([...kept.next()!], [4]);
  kept.pass(1);
  assert.equal(kept.next(), null);
  kept.rewind();
  assert.deepEqual([...kept.next()!], [1, 2, 3]);
});

test('a window grows by a quarter, within the terrain', () => {
  assert.deepEqual(widened([10, 10, 18, 26], [0, 0, 100, 27], 1 / 8), [9, 8, 19, 27]);
});

test('the picture has the scale of its middle parallel, and feet are feet', () => {
  const facts = {
    originX: 10, originY: 59, stepX: 1, stepY: 1, heightIsFloat: 0, heightStep: 1, heightOffset: 0, minX: 0, minY: 0, maxX: 1,
    maxY: 2, minHeight: 0, maxHeight: 100, baseError: 0, baseDeviation: 0,
  };
  const earth = {
    isDegrees: true, lengths: { unit: 'metre', metres: 1 }, metresPerHeight: 0.3048, curvature: 0, lightSpeed: 1, size: null,
    scales: [{ y: 59, x: 57000, perY: 111400 }, { y: 61, x: 54000, perY: 111420 }],
  };
  assert.deepEqual(scaleAt(earth, 60), [55500, 111410]);
  assert.deepEqual(scaleAt(earth, 58), [57000, 111400]);
  const frame = new Frame(facts, { horizontal: 'degree', height: 'foot' }, earth);
  assert.equal(frame.depth, 222820);
  assert.equal(frame.width, 55500);
  assert.ok(Math.abs(frame.relief - 30.48) < 1e-9);
  assert.equal(frame.mapX(frame.sceneX(10.25)), 10.25);
  assert.deepEqual(frame.bounds, [10, 59, 11, 61]);
});

test('a place of a projected terrain is told in degrees, too, with the decimals that are certain', () => {
  // Web Mercator from 179 to 181 degrees east.
  const radius = 6378137, degree = Math.PI / 180, west = 179 * degree * radius, south = 5e6, aside = 2 * degree * radius;
  const latitude = (y: number): number => Math.atan(Math.sinh(y / radius)) / degree;
  const facts = {
    originX: west, originY: south, stepX: aside / 100, stepY: 2000, heightIsFloat: 0, heightStep: 1, heightOffset: 0,
    minX: 0, minY: 0, maxX: 100, maxY: 100, minHeight: 0, maxHeight: 100, baseError: 0, baseDeviation: 0,
  };
  const earth = {
    isDegrees: false, lengths: { unit: 'metre', metres: 1 }, metresPerHeight: 1, curvature: 0, lightSpeed: 1, size: null,
    scales: [{ y: 0, x: 1, perY: 1 }],
  };
  const nodes = Array.from({ length: 16 }, (_, i): [number, number] => [179 + 2 / 3 * (i % 4), latitude(south + 2e5 / 3 * Math.floor(i / 4))]);
  const degreesAt = (within: number, x: number, y: number): string[] =>
    new Frame(facts, { horizontal: 'metre', height: 'metre' }, earth, { nodes, within }).where({ x, y }).split('\n')[1].split('  ');
  for (const [across, up] of [[0.1, 0.9], [0.45, 0.55], [0.2, 0.17]] as const) {
    const [lat, lon] = degreesAt(1e-6, west + across * aside, south + up * 2e5);
    assert.equal(lon, `${(179 + 2 * across).toFixed(5)}\u00b0 E`);
    assert.equal(lat, `${latitude(south + up * 2e5).toFixed(5)}\u00b0 N`);
  }
  assert.deepEqual(degreesAt(0.004, west + 0.75 * aside, south), [`${latitude(south).toFixed(2)}\u00b0 N`, '179.50\u00b0 W']);
  const native = new Frame(facts, { horizontal: 'metre', height: 'metre' }, earth).where({ x: west, y: south });
  assert.doesNotMatch(native, /\u00b0/);
});

test('metadata that tell no ground, or nonsense, tell nothing', () => {
  assert.equal(toldBy(null).ground, null);
  assert.equal(toldBy({ ground: { geographic: true, semi_major: -1, metres_per_height: 1, radians_per_map_unit: 1 } }).ground, null);
  assert.equal(toldBy({ free_of_voids: true }).freeOfVoids, true);
});

test('a base map is an address of the web with three places', () => {
  const mapOf = (tiles: unknown): unknown => toldBy({ base_map: { tiles, attribution: 'Who' } }).baseMap;
  assert.deepEqual(mapOf('https://h/{z}/{x}/{y}'), { tiles: 'https://h/{z}/{x}/{y}', attribution: 'Who' });
  assert.notEqual(mapOf('https://h:1?z={TileMatrix}&x={TileCol}&y={TileRow}'), null, 'the program takes it, too');
  for (const tiles of ['https://h/{z}/{x}', 'https:///{z}/{x}/{y} ://', 'javascript:{z}{x}{y}', 'https://[/{z}/{x}/{y}', 7, undefined]) {
    assert.equal(mapOf(tiles), null, String(tiles));
  }
  assert.equal(toldBy({ base_map: null }).baseMap, null);
});

test('what an answer cost, in words', () => {
  const response = new Response(null, { headers: { 'Server-Timing': 'query;dur=28.94;desc="pages=126 stars=0 records=3961"' } });
  assert.equal(costOf(response), '126 pages, 29 ms');
  assert.equal(costOf(new Response(null)), '');
});

test('a file whose connection broke is read on', async () => {
  const bytes = readFileSync(terrain('mountains_257').stream);
  let answers = 0;
  const web = await host('.', {
    answer: (_, response) => {
      response.writeHead(200, { 'Content-Length': bytes.length, ETag: '"a"' });
      if (++answers === 1) response.write(bytes.subarray(0, 60000), () => { response.destroy(); });
      else response.end(bytes);
      return true;
    },
  });
  const faults: unknown[] = [];
  try {
    const view = await new Promise<FileView>((resolve) => {
      const opened = new FileView('m', new HostedBytes(`${web.url}m.ptins`).open(), decoderModule(), '', 1e9, {
        grown: () => undefined, settled: () => { resolve(opened); }, failed: (error) => { faults.push(error); }, mended: () => undefined,
      });
      void opened.run();
    });
    assert.deepEqual([view.progress.state, faults, answers], ['complete', [], 2]);
  } finally {
    await web.close();
  }
});

test('an answer that tells no certificate has none', () => {
  const nothing = { of: 'terrain', error: null, deviation: null, isExact: false };
  assert.deepEqual(certaintyOf({}), nothing);
  assert.deepEqual(certaintyOf({ certified_error: null, certified_deviation: null, exact: false }), nothing);
  assert.deepEqual(certaintyOf({ certified_error: 0, certified_deviation: 2.5, exact: false }), { ...nothing, error: 0, deviation: 2.5 });
});

test('refinement stops at an error, becomes coarser again, and goes on', () => {
  const stream = readFileSync(terrain('mountains_257').stream);
  const still = new StaticStream(decoderModule(), { error: 0, mostVertices: 1e9 });
  still.kept.add(stream);
  const apply = (): void => { while (still.apply(1e9)); };
  still.setError(10);
  apply();
  assert.equal(still.heldBy, 'error');
  const first = { error: still.decoder.certificate!.error, vertices: still.decoder.mesh.vertexCount };
  assert.ok(first.error <= 10);
  still.setError(1);
  apply();
  assert.ok(still.decoder.certificate!.error <= 1 && still.decoder.mesh.vertexCount > first.vertices);
  still.setError(10);
  apply();
  assert.equal(still.decoder.mesh.vertexCount, first.vertices);
  still.setError(0);
  apply();
  assert.ok(still.decoder.isComplete);
  assert.equal(still.decoder.mesh.vertexCount, 257 * 257);
});

test('refinement stops at a number of vertices', () => {
  const still = new StaticStream(decoderModule(), { error: 0, mostVertices: 20000 });
  still.kept.add(readFileSync(terrain('mountains_257').stream));
  while (still.apply(1e9));
  assert.equal(still.heldBy, 'vertices');
  assert.ok(still.decoder.mesh.vertexCount <= 20000);
});

test('what is drawn has upward normals, every edge of the surface once, its voids apart, and walls along its border', () => {
  const decoder = decoded(decoderModule(), readFileSync(terrain('coast_257', '--error', '5').stream));
  const { mesh, facts } = decoder;
  const told = toldBy(decoder.metadata);
  decoder.describe(told.ground);
  const drawn = drawnMesh(mesh, new Frame(facts, told.units, earthOf(decoder, told)));
  const surface = mesh.classes.reduce((n, c) => n + (c === 0 ? 1 : 0), 0);
  const corners = drawn.corners.subarray(0, surfaceEnd(drawn.parts));
  assert.equal(corners.length, 3 * surface);
  assert.equal(drawn.corners.length, 3 * mesh.triangleCount);
  for (const v of corners) assert.ok(drawn.normals[4 * v + 2] > 0);
  const edges = edgesOf(corners, drawn.positions.length / 3);
  const names = new Set<string>();
  for (let i = 0; i < edges.length; i += 2) {
    const [a, b] = [edges[i], edges[i + 1]].sort((p, q) => p - q);
    names.add(`${a} ${b}`);
  }
  assert.equal(names.size, edges.length / 2);
  const all = new Set<string>();
  for (let i = 0; i < corners.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [corners[i + k], corners[i + (k + 1) % 3]].sort((p, q) => p - q);
      all.add(`${a} ${b}`);
    }
  }
  assert.deepEqual([...names].sort(), [...all].sort());
  const border = mesh.triangles.reduce((n, word) => n + (word === 0xffffffff ? 1 : 0), 0);
  assert.equal(drawn.walls.length, 16 * border);
  for (let i = 0; i < drawn.positions.length; ++i) assert.ok(Number.isFinite(drawn.positions[i]));
});

test('rays and plumb lines meet the drawn ground at the same places', () => {
  const drawn = drawnOf(terrain('mountains_257', '--error', '20').stream);
  const ground = new Ground(drawn.positions, drawn.corners, drawn.grid);
  const { west, south, east, north } = drawn.extent;
  let met = 0;
  for (let i = 0; i < 200; ++i) {
    const x = west + (east - west) * ((i * 0.618) % 1), y = south + (north - south) * ((i * 0.3819 + 0.1) % 1);
    const from: [number, number, number] = [x - 4000, y + 2500, 9000];
    const z = ground.at(x, y);
    assert.ok(z !== null);
    const straight = ground.meets([x, y, 9000], [0, 0, -1]);
    assert.ok(straight !== null && Math.abs(9000 - straight - z) < 0.01);
    const share = ground.meets(from, [4000, -2500, z - 9000]);
    assert.ok(share !== null && share <= 1 + 1e-5, 'at that place, or before it');
    const [mx, my, mz] = [from[0] + share * 4000, from[1] - share * 2500, from[2] + share * (z - 9000)];
    assert.ok(Math.abs((ground.at(mx, my) ?? Infinity) - mz) < 0.5);
    if (share > 1 - 1e-5) ++met;
  }
  assert.ok(met > 100, `${met} are not hidden`);
  assert.equal(ground.at(east + 1, south), null);
  assert.equal(ground.meets([0, 0, 9000], [0, 0, 1]), null);
});

/** A flat grid of 40 by 40 samples on which `heights` says what is not flat. */
function drawnGrid(name: string, heights: (row: number, column: number) => number): DrawnMesh {
  const rows = Array.from({ length: 40 }, (_, r) => Array.from({ length: 40 }, (_, c) => heights(r, c).toFixed(1)));
  return drawnOf(gridded(name, 'EPSG:32633', [400000, 5000000], 100, rows).stream);
}

function drawnOf(stream: string): DrawnMesh {
  const decoder = decoded(decoderModule(), readFileSync(stream));
  const told = toldBy(decoder.metadata);
  decoder.describe(told.ground);
  return drawnMesh(decoder.mesh, new Frame(decoder.facts, told.units, earthOf(decoder, told)));
}

test('colours go by the area of heights, whatever outliers there are', () => {
  const rough = (r: number, c: number): number => 100 + 40 * Math.sin(r / 3) * Math.cos(c / 4) + (r * 7 + c * 3) % 5;
  const plain = drawnGrid('plain', rough).spread!;
  const spiked = drawnGrid('spiked', (r, c) => (r === 20 && c === 20 ? 9000 : rough(r, c))).spread!;
  assert.ok(plain.high - plain.low > 50 && plain.high - plain.low < 90);
  // A spike draws its neighbours along, a few of 1600 squares.
  assert.ok(spiked.high - spiked.low < 1.3 * (plain.high - plain.low), `${spiked.high - spiked.low}`);
});

test('water is what is flat at 0, or flat, large and below its shores', () => {
  const hills = (r: number, c: number): number => 30 + 8 * Math.sin(r / 2) * Math.sin(c / 2) + ((r * 5 + c * 11) % 7) / 2;
  const waters = ({ parts }: DrawnMesh): number => (parts[parts.length - 2] - parts[parts.length - 3]) / 3;
  const inside = (r: number, c: number): boolean => r > 10 && r < 25 && c > 12 && c < 30;
  assert.equal(waters(drawnGrid('dry', hills)), 0);
  assert.ok(waters(drawnGrid('sea', (r, c) => (c < 12 ? 0 : hills(r, c)))) > 0);
  assert.ok(waters(drawnGrid('lake', (r, c) => (inside(r, c) ? 12 : hills(r, c)))) > 0);
  assert.equal(waters(drawnGrid('plateau', (r, c) => (inside(r, c) ? 80 : hills(r, c)))), 0);
});

test('a sea that a coarse mesh crosses in long shallow triangles is one, and marshes beside it are land', () => {
  const corners = [[0, 0, 0], [300, 0, 0], [0, 10, 0], [600, 20, 1], [300, 30, 3], [900, 40, 2], [310, 40, 2], [305, 45, 2], [900, 70, 60]];
  const triangles = [[0, 1, 2], [1, 3, 4], [3, 5, 4], [6, 7, 4], [5, 8, 3]];
  assert.deepEqual(kinds(corners, triangles.map((t) => [...t, none, none, none]), 100), [water, water, water, land, land]);
});

test('a thin dam of triangles from coast to coast is water, and the land beside it is not', () => {
  const corners = [[0, 0, 0], [100, 0, 0], [100, 10, 0], [101, 0, 2], [101, 10, 2], [108, 5, 2]];
  // With the neighbours across from their corners.
  const triangles = [[0, 1, 2, 1, none, none], [1, 3, 2, 2, 0, none], [3, 4, 2, none, 1, 3], [3, 5, 4, none, 2, none]];
  assert.deepEqual(kinds(corners, triangles, 400), [water, water, water, land]);
});

/** The kinds of triangles of a mesh on a terrain of 1000 steps by some. */
function kinds(corners: number[][], triangles: number[][], maxY: number): number[] {
  const mesh = {
    vertexCount: corners.length, triangleCount: triangles.length, vertices: Int32Array.from(corners.flatMap((c) => [...c, 0])), classes: new Uint8Array(triangles.length),
    triangles: Uint32Array.from(triangles.flat()), hasHeight: new Uint8Array(corners.length).fill(1), facts: new Uint8Array(),
  };
  const facts = { minX: 0, minY: 0, maxX: 1000, maxY, minHeight: 0, maxHeight: 100, heightIsFloat: 0, heightStep: 1, heightOffset: 0 } as unknown as Facts;
  return [...kindsOf(mesh, facts)];
}

test("the tree of a base map's tiles finds each of them, in rows that every card takes", () => {
  // Each tile at the finest level, in a part of its own.
  const tiles = Array.from({ length: 128 }, (_, i) => ({ up: 19, column: (i * 7919 + 13) % 2 ** 20, row: (i * 104729 + 5) % 2 ** 20 }));
  const tree = treeOf(new Map(tiles.map((tile, layer) => [nameOf(tile), layer])));
  assert.ok(tree.length / 2 > 2048 && tree.length % (2 * treeRow) === 0 && treeRow <= 2048 && tree.length / 2 / treeRow <= 2048);
  for (const [layer, { up, column, row }] of tiles.entries()) {
    let first = 0, entry = 0;
    for (let depth = up; depth >= 0; --depth) {
      entry = first + (column >> depth & 1) + 2 * (row >> depth & 1);
      first = tree[2 * entry + 1];
    }
    assert.equal(tree[2 * entry], layer + 1);
    assert.equal(first, 0);
  }
});
