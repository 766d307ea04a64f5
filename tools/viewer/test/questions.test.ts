// SPDX-License-Identifier: GPL-3.0-or-later
//
// The engine's answers in WebAssembly about the mesh that is shown, against the program's of the same mesh: on a plane in metres, over
// degrees of several parallels, with heights in feet over metres, with voids.
import { boundsOf, DecodeError, type Decoder, type MapPosition, onMap, type Told, toldBy } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { type Earth, earthOf } from '../src/earth';
import { drawnSight } from '../src/drawn_sight';
import { Frame } from '../src/frame';
import { type Asked, Questions } from '../src/questions';
import { decoded, decoderModule, file, made, ptin, questionsModule, terrain } from '../../decoder/test/support';

const error = '5';
const questions = new Questions(questionsModule());

interface Shown {
  store: string;
  decoder: Decoder;
  /** Within the stream's certificate. */
  asked: Asked;
  told: Told;
  earth: Earth;
  frame: Frame;
  /** A place of the terrain, and a little beyond. */
  place: (i: number) => MapPosition;
}

function askedOf(decoder: Decoder, told: Told): Asked {
  return { decoder, ground: told.ground, freeOfVoids: told.freeOfVoids, certificate: decoder.certificate, isWhole: false };
}

function shown(store: string, streamed: string): Shown {
  const decoder = decoded(decoderModule(), readFileSync(streamed));
  const told = toldBy(decoder.metadata);
  decoder.describe(told.ground);
  const share = (n: number): number => (n * 0.6180339887498949) % 1;
  const [x, y, east, north] = boundsOf(decoder.facts);
  const width = east - x, depth = north - y;
  const earth = earthOf(decoder, told);
  return {
    store, decoder, asked: askedOf(decoder, told), told, earth, frame: new Frame(decoder.facts, told.units, earth),
    place: (i) => ({
      x: Number((x + (1.02 * share(i) - 0.01) * width).toPrecision(9)), y: Number((y + (1.02 * share(i * 7.31) - 0.01) * depth).toPrecision(9)),
    }),
  };
}

const plane = terrain('mountains_257', '--error', error);
const terrains: Array<[string, () => Shown]> = [
  ['metres', () => shown(plane.store, plane.stream)],
  ...(['degrees', 'feet', 'voids'] as const).map((name): [string, () => Shown] => [name, () => {
    const { store, stream } = made(name, '--error', error);
    return shown(store, stream);
  }]),
];

for (const [name, of] of terrains) {
  const t = of();
  const { asked, decoder, store, place } = t;
  const line = (a: MapPosition, b: MapPosition): string => `LINESTRING(${a.x} ${a.y}, ${b.x} ${b.y})`;

  test(`heights are those of locate at the same error: ${name}`, () => {
    const places = Array.from({ length: 60 }, (_, i) => place(i));
    writeFileSync(file('places.csv'), `x,y\n${places.map((at) => `${at.x},${at.y}\n`).join('')}`);
    const locateAll = (...options: string[]) =>
      (JSON.parse(ptin('locate', store, '--points', file('places.csv'), ...options, '--json')) as
        { points: Array<{ state: string; height: number | null }> }).points;
    const told = locateAll('--error', error), exact = locateAll();
    let surface = 0;
    for (const [i, at] of places.entries()) {
      const here = questions.locate(asked, at);
      assert.equal(here.state, told[i].state);
      assert.equal(here.height, told[i].height);
      const full = exact[i].height;
      if (here.height === null || full === null) continue;
      ++surface;
      assert.ok((here.least as number) <= full && full <= (here.most as number), 'the full terrain is in the interval');
      assert.equal(here.triangle.length, 3);
      const far = questions.locate({ ...asked, certificate: null }, at);
      assert.ok((far.least as number) <= (here.least as number), 'without a certificate it is as wide as the relief');
    }
    assert.ok(surface > 20);
  });

  test(`profiles are those of the program, point by point: ${name}`, () => {
    const ends = Array.from({ length: 12 }, (_, i) => [place(2 * i), place(2 * i + 1)]);
    const lines = `MULTILINESTRING(${ends.map(([a, b]) => `(${a.x} ${a.y}, ${b.x} ${b.y})`).join(', ')})`;
    const all = (JSON.parse(ptin('profile', store, '--line', lines, '--error', error, '--json')) as
      { points: Array<MapPosition & { line: number; distance: number; height: number | null }> }).points;
    for (const [i, [a, b]] of ends.entries()) {
      const told = all.filter((p) => p.line === i);
      const { stations, length } = questions.profile(asked, a, b);
      const last = told[told.length - 1].distance;
      // On the ellipsoid both formulas agree to a tenth of a millimetre.
      const slack = t.earth.isDegrees ? 1e-4 : 0;
      assert.ok(Math.abs(length - last) <= slack, `${length} for ${last}`);
      const heights = stations.filter((s) => s.height !== null), wanted = told.filter((p) => p.height !== null);
      assert.equal(heights.length, wanted.length);
      for (const [k, p] of wanted.entries()) {
        const s = heights[k];
        assert.deepEqual([s.x, s.y, s.height], [p.x, p.y, p.height]);
        assert.ok(Math.abs(s.distance - p.distance) <= slack);
      }
    }
  });

  test(`lines of sight never contradict the program's: ${name}`, () => {
    let decided = 0;
    const ends = Array.from({ length: 25 }, (_, i) => [place(3 * i + 1), place(3 * i + 2)]);
    writeFileSync(file('pairs.txt'), ends.map(([a, b]) => `${a.x} ${a.y} 40 ${b.x} ${b.y} 60\n`).join(''));
    const { pairs } = JSON.parse(ptin('sight', store, '--pairs', file('pairs.txt'), '--frequency', '450MHz', '--json')) as
      { pairs: Array<{ verdict: string; length: number; clearance: { min: number; max: number } | null }> };
    assert.equal(pairs.length, ends.length);
    for (const [i, [a, b]] of ends.entries()) {
      const told = pairs[i];
      const here = questions.sight(asked, a, 40, b, 60, 450e6);
      assert.ok(Math.abs(here.length - told.length) <= 1e-3, `${here.length} for ${told.length}`);
      if (here.verdict === 'unsure') continue;
      if (here.verdict === 'undefined') {
        assert.ok(!['visible', 'hidden'].includes(told.verdict), told.verdict);
        continue;
      }
      // The line that is drawn goes through the points that the engine names.
      const request = { observerHeight: 40 * t.frame.scaleZ, targetHeight: 60 * t.frame.scaleZ, frequency: 450e6 };
      const profile = { ...questions.profile(asked, a, b), lengths: t.earth.lengths };
      const drawn = drawnSight({ request, sight: here, profile }, t.frame);
      assert.ok(here.clearance !== null || here.verdict !== 'visible', 'a visible line has a clearance');
      if (here.clearance !== null) {
        const { distance, height } = here.clearance.at;
        assert.ok(Math.abs(drawn.at(distance / here.length) - height) < 1e-3, `${drawn.at(distance / here.length)} for ${height}`);
      }
      const half = Math.sqrt(299792458 / 450e6 * here.length * t.frame.scaleZ) / 2;
      assert.ok(Math.abs(drawn.radius(0.5) * t.frame.scaleZ - half) < 1e-6);
      ++decided;
      assert.equal(here.verdict, told.verdict);
      if (here.clearance === null || told.clearance === null) continue;
      assert.ok(here.clearance.min <= told.clearance.max + 1e-9 && here.clearance.max >= told.clearance.min - 1e-9);
    }
    // Where there are voids, what is left out may be one at any place.
    assert.ok(name === 'voids' || decided > 3, `${decided} are decided`);
  });

  test(`the size of the terrain is that of the program's lines: ${name}`, () => {
    const { facts } = decoder;
    const middle = (facts.minY + facts.maxY) / 2;
    const across = line(onMap(facts, facts.minX, middle), onMap(facts, facts.maxX, middle));
    const told = JSON.parse(ptin('profile', store, '--line', across, '--json')) as { points: Array<{ distance: number }> };
    const length = told.points[told.points.length - 1].distance;
    assert.ok(Math.abs((t.earth.size as [number, number])[0] - length) < 1e-3);
  });
}

test('without metadata on the ground no length is known', () => {
  const t = terrains[1][1]();
  const earth = earthOf(t.decoder, toldBy({ units: { horizontal: 'degree', height: 'metre' } }));
  assert.equal(earth.size, null);
});

test('a line around the Earth has no length here', () => {
  const t = terrains[1][1]();
  assert.ok(Number.isNaN(t.decoder.metresBetween({ x: 0, y: 10 }, { x: 179, y: -10 })));
  assert.ok(Math.abs(t.decoder.metresBetween({ x: 170, y: -17 }, { x: -170, y: -16 }) - 2137231.521266) < 1e-3, 'across the date line');
});

test('questions are of the mesh as it is now, of whichever decoder', () => {
  const bytes = readFileSync(plane.stream);
  const half = decoded(decoderModule(), bytes.subarray(0, bytes.length / 2)), whole = decoded(decoderModule(), bytes);
  const told = toldBy(whole.metadata);
  const { place } = terrains[0][1]();
  const heights = (decoder: Decoder, by = questions): Array<number | null> =>
    Array.from({ length: 20 }, (_, i) => by.locate(askedOf(decoder, told), place(i)).height);
  const coarse = heights(half), fine = heights(whole);
  assert.notDeepEqual(coarse, fine);
  assert.deepEqual(heights(half), coarse);
  half.feed(bytes.subarray(bytes.length / 2));
  assert.ok(half.isComplete);
  assert.deepEqual(heights(half), fine, 'what came since counts');
  assert.deepEqual(heights(whole, new Questions(questionsModule())), fine, 'another instance says the same');
});

test('a question that is refused hurts no other', () => {
  const { asked, decoder, place } = terrains[0][1]();
  const before = questions.locate(asked, place(3));
  const { vertexCount } = decoder.mesh;
  assert.throws(() => { questions.profile(asked, place(3), place(3)); }, (error: unknown) => {
    assert.ok(error instanceof DecodeError);
    assert.equal(error.code, 'invalid_argument');
    assert.match(error.message, /no length/);
    return true;
  });
  assert.throws(() => { questions.locate(asked, { x: NaN, y: 0 }); }, DecodeError);
  assert.deepEqual(questions.locate(asked, place(3)), before);
  assert.equal(decoder.mesh.vertexCount, vertexCount);
});
