// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera over the terrain, without a picture.
import { widened, type Window } from 'ptin-decoder';
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Frame } from '../src/frame';
import { heightCellsOf, someBox } from '../src/height_cells';
import { Camera, lengthOf, type Triple } from '../src/space';
import { usualExaggeration, View } from '../src/view';

const relief = (x: number, y: number): number => 750 + 750 * Math.sin(x / 330) * Math.cos(y / 400);

/** The first place of a way that is below the hills, in small steps. */
function meets(from: Triple, way: Triple): number | null {
  for (let share = 0; share < 30000; share += 5) {
    const [x, y, z] = from.map((v, i) => v + share * way[i]);
    if (Math.abs(x) > 3840 || Math.abs(y) > 3840) continue;
    if (z <= relief(x, y)) return share;
  }
  return null;
}

/** The hills as triangles of some 80 m, which are off by less than 25 m. */
function hills(): { positions: Float32Array; corners: Uint32Array } {
  const across = 97, size = 7680 / (across - 1);
  const positions: number[] = [], corners: number[] = [];
  for (let k = 0; k < across; ++k) {
    for (let i = 0; i < across; ++i) {
      const x = i * size - 3840, y = k * size - 3840, at = k * across + i;
      positions.push(x, y, relief(x, y));
      if (i + 1 < across && k + 1 < across) corners.push(at, at + 1, at + across, at + 1, at + across + 1, at + across);
    }
  }
  return { positions: Float32Array.from(positions), corners: Uint32Array.from(corners) };
}

function framed(minHeight = 300, maxHeight = 1800): Frame {
  const facts = {
    originX: 500000, originY: 5000000, stepX: 30, stepY: 30, heightIsFloat: 0, heightStep: 1, heightOffset: 0, minX: 0, minY: 0,
    maxX: 256, maxY: 256, minHeight, maxHeight, baseError: 0, baseDeviation: 0,
  };
  const earth = {
    isDegrees: false, lengths: { unit: 'metre', metres: 1 }, metresPerHeight: 1, curvature: 0, lightSpeed: 1, size: null,
    scales: [{ y: 5000000, x: 1, perY: 1 }],
  };
  return new Frame(facts, { horizontal: 'metre', height: 'metre' }, earth);
}

/** A view of a hilly terrain of some kilometres; `rest` draws until it rests, and returns the number of pictures. */
function viewed(): { view: View; rest: () => number } {
  Object.assign(globalThis, { matchMedia: () => ({ matches: false }) });
  const camera = new Camera();
  Object.assign(camera, { width: 1100, height: 720 });
  const { positions, corners } = hills();
  const cells = heightCellsOf(positions, corners, new Uint32Array(), 1500);
  const view = new View(camera, { groundAt: relief, meets, someBox: (...asked) => someBox(cells, ...asked) });
  view.setFrame(framed());
  let hasChanged = false;
  view.changed = () => { hasChanged = true; };
  const rest = (): number => {
    for (let pictures = 1; pictures < 100; ++pictures) {
      hasChanged = false;
      if (!view.update() && !hasChanged) return pictures;
    }
    return Infinity;
  };
  return { view, rest };
}

const above = ({ camera: { position: [x, y, z] } }: View): number => z - relief(x, y);

test('a view comes to rest wherever keys lead it, at its nearest and its farthest, too', () => {
  const { view, rest } = viewed();
  for (const factor of [0.5, 2]) {
    for (let heading = 0; heading < 360; heading += 30) {
      view.reset();
      view.turn(heading);
      for (let step = 0; step < 30; ++step) {
        view.zoom(factor);
        view.pan(0.1, 0.2);
        view.tilt(5);
        assert.ok(rest() < 100, `heading ${heading}, factor ${factor}, step ${step}`);
      }
    }
  }
});

test('the camera stays above the ground: wheel steps, tilts, rounds, and drags', () => {
  const { view, rest } = viewed();
  for (const at of [{ x: 0, y: 0 }, { x: 0.6, y: -0.7 }, { x: -0.5, y: 0.4 }]) {
    view.reset();
    for (let step = 0; step < 40; ++step) view.zoomAt(at, 0.7);
    for (let step = 0; step < 20; ++step) {
      view.tilt(5);
      rest();
      assert.ok(above(view) > 0, `step ${step}`);
      view.orbit(view.pivotAt(at), 7, 5);
      view.drag({ x: 0, y: 0 }, { x: 0.1, y: -0.2 }, view.levelAt(at));
      view.settle();
      rest();
      assert.ok(above(view) > 0, `step ${step}, after a round`);
      assert.ok(lengthOf(view.camera.position) < 1e6 && Number.isFinite(view.distance));
    }
  }
});

test('what is under the pointer stays there while it is dragged, and while the wheel turns', () => {
  const { view } = viewed();
  const at = { x: 0.3, y: -0.2 };
  const seen = (place: Triple): { x: number; y: number } => view.camera.project(place)!;
  const grabbed = view.pivotAt(at);
  view.drag(at, { x: 0.1, y: -0.4 }, grabbed[2]);
  assert.ok(Math.abs(seen(grabbed).x - 0.1) < 1e-6 && Math.abs(seen(grabbed).y + 0.4) < 1e-6);
  view.zoomAt({ x: 0.1, y: -0.4 }, 0.5);
  assert.ok(Math.abs(seen(grabbed).x - 0.1) < 0.01 && Math.abs(seen(grabbed).y + 0.4) < 0.01, 'nearer');
  view.orbit(grabbed, 40, -10);
  assert.ok(Math.abs(seen(grabbed).x - 0.1) < 1e-6, 'round it');
});

test('the scene is projected as the matrix has it', () => {
  const { view } = viewed();
  view.exaggeration = 3;
  const at = view.project(700, -300, 900);
  const m = view.camera.matrix;
  const row = (i: number): number => m[i] * 700 + m[4 + i] * -300 + m[8 + i] * 2700 + m[12 + i];
  assert.ok(Math.abs(at.x - (row(0) / row(3) + 1) / 2 * 1100) < 1e-6);
  assert.ok(Math.abs(at.y - (1 - row(1) / row(3)) / 2 * 720) < 1e-6);
  assert.equal(at.visible, true);
  const { position, forward } = view.camera;
  const [x, y, z] = position.map((v, i) => v - 100 * forward[i]);
  assert.equal(view.project(x, y, z / 3).visible, false, 'behind the camera');
});

test('a more exact frame of the terrain leaves the camera over its place on the map', () => {
  const { view } = viewed();
  const pose = { x: 501234.5, y: 5006543.25, height: 1000, distance: 900, heading: 40, tilt: 60 };
  view.pose(pose);
  const { facts, units, earth } = framed();
  view.replaceFrame(new Frame(facts, units, { ...earth, scales: [{ y: 5000000, x: 1.003, perY: 1.0006 }] }));
  const now = view.current!;
  for (const [key, value] of Object.entries(pose)) assert.ok(Math.abs(now[key as keyof typeof now] - value) < 1e-6, `${key}: ${now[key as keyof typeof now]}`);
});

test('heights of a unit that nobody told are told in that for which they are taken', () => {
  const { facts, earth } = framed();
  const units = { horizontal: 'foot', height: 'unknown' };
  assert.equal(new Frame(facts, units, { ...earth, metresPerHeight: 0.3048 }).units.height, 'foot');
  assert.equal(new Frame(facts, units, earth).units.height, 'unknown', 'metres');
});

test('windows are in sight where the picture may show a part of them, however large they are', () => {
  const { view, rest } = viewed();
  // Near the ground in the middle of the terrain, looking north.
  view.pose({ x: 503840, y: 5003840, height: 1000, distance: 900, heading: 0, tilt: 60 });
  rest();
  const isSeen = view.seenWindows(framed(), []);
  const [west, south, east, north] = [500000, 5000000, 507680, 5007680];
  const { camera } = view;
  const shown = (x: number, y: number): boolean => [0, 500, 1000, 1500].some((z) => {
    const at = camera.project([x - 503840, y - 5003840, z * view.exaggeration]);
    return at !== null && Math.abs(at.x) < 1 && Math.abs(at.y) < 1;
  });
  for (let i = 0; i < 12; ++i) {
    for (let k = 0; k < 12; ++k) {
      const x = west + 640 * i, y = south + 640 * k;
      if (shown(x + 320, y + 320)) assert.ok(isSeen([x, y, x + 640, y + 640]), `${i} ${k}`);
    }
  }
  assert.ok(isSeen([west, south, east, north]));
  // All that lies to the west up to where the camera stands, behind it and beside: no pixel has any of it.
  assert.ok(!isSeen([west, south, 502300, 5003800]) && !isSeen([west, south, east, 5002500]));
  // Parts that are wanted are those seen, in a valley far below the terrain's middle height, too.
  for (const [x, y] of [[503840, 5003840], [505400, 5003840], [503300, 5004400]]) {
    view.pose({ x, y, height: 300 + relief(x - 503840, y - 5003840), distance: 400, heading: 40, tilt: 55 });
    rest();
    const [farthest] = view.wanted(720, 0.33);
    for (let i = -4; i <= 4; ++i) {
      const [px, py, pz] = view.camera.position, ray = view.camera.ray(i / 4, -0.9);
      const share = meets([px, py, pz / view.exaggeration], [ray[0], ray[1], ray[2] / view.exaggeration]);
      if (share === null) continue;
      const [atX, atY] = [503840 + px + share * ray[0], 5003840 + py + share * ray[1]];
      const [w, s, e, n] = farthest.window;
      assert.ok(atX > w - 60 && atX < e + 60 && atY > s - 60 && atY < n + 60, `${i}: ${atX} ${atY} in ${farthest.window}`);
    }
  }
});

test('windows whose ground is certified are in sight where that may be', () => {
  const { view, rest } = viewed();
  const bounds: Window = [500000, 5000000, 507680, 5007680];
  const deviation = 40, size = 7680 / 24;
  let seen = 0, mayBe = 0;
  for (const [heading, tilt, distance] of [[0, 70, 900], [200, 50, 2500], [60, 80, 400], [330, 30, 1500]]) {
    view.pose({ x: 503840, y: 5003840, height: 1000, distance, heading, tilt });
    rest();
    const isSeen = view.seenWindows(framed(), [{ window: bounds, error: 20, deviation }]);
    const isAnyhow = view.seenWindows(framed(), []);
    for (let i = 0; i < 24 * 24; ++i) {
      const x = -3840 + size * (i % 24), y = -3840 + size * Math.floor(i / 24);
      const window: Window = [503840 + x, 5003840 + y, 503840 + x + size, 5003840 + y + size];
      if (isAnyhow(window)) ++mayBe;
      if (isSeen(window)) ++seen;
      // All that the ground may be there, in steps.
      for (let step = 0; step < 75; ++step) {
        const [px, py] = [x + size * (step % 5) / 4, y + size * (Math.floor(step / 5) % 5) / 4];
        const at = view.camera.project([px, py, relief(px, py) + 0.6 * deviation * (Math.floor(step / 25) - 1)]);
        if (at === null || Math.abs(at.x) > 1 || Math.abs(at.y) > 1) continue;
        assert.ok(isSeen(window), `heading ${heading}: ${px} ${py}`);
      }
    }
  }
  assert.ok(seen < 0.9 * mayBe, `${seen} of ${mayBe}`);
});

test('what may be in sight is wanted, where no ray of the picture meets it, too', () => {
  const { view, rest } = viewed();
  const bounds: Window = [500000, 5000000, 507680, 5007680];
  const deviation = 40, size = 7680 / 64;
  let hidden = 0;
  for (const [heading, tilt, distance] of [[0, 70, 900], [200, 50, 2500], [60, 80, 400], [330, 30, 1500]]) {
    view.pose({ x: 503840, y: 5003840, height: 1000, distance, heading, tilt });
    rest();
    const isSeen = view.seenWindows(framed(), [{ window: bounds, error: 20, deviation }]);
    const heldBy = (slack: number) => {
      const parts = view.wanted(720, 0.6, slack).map((part) => widened(part.window, bounds, 1 / 8));
      return (x: number, y: number): boolean => parts.some(([w, s, e, n]) => x >= w && x <= e && y >= s && y <= n);
    };
    const isWanted = heldBy(deviation), isMet = heldBy(0);
    for (let i = 0; i < 64 * 64; ++i) {
      const x = bounds[0] + size * (i % 64 + 0.5), y = bounds[1] + size * (Math.floor(i / 64) + 0.5);
      if (!isSeen([x - 0.49 * size, y - 0.49 * size, x + 0.49 * size, y + 0.49 * size])) continue;
      assert.ok(isWanted(x, y), `heading ${heading}: ${x} ${y}`);
      if (!isMet(x, y)) ++hidden;
    }
  }
  assert.ok(hidden > 50, `${hidden} cells that no ray meets`);
});

test('the heights of cells hold those of all triangles there', () => {
  const positions = Float32Array.from([0, 0, 0, 100, 0, 50, 0, 100, 20, 100, 100, 90, 40, 40, 7, 60, 60, 95, 50, 50, 12,
    200, 0, 5, 201, 0, 5, 200, 1, 5]);
  // The last stands on its edge.
  const corners = Uint32Array.from([0, 1, 2, 1, 3, 2, 4, 5, 6]);
  const cells = heightCellsOf(positions, corners, Uint32Array.from([0, 1, 2].map((i) => i + 7)), 2000);
  const within = (window: Window): [low: number, high: number] => {
    let low = Infinity, high = -Infinity;
    someBox(cells, window, 0, (least, most) => {
      [low, high] = [Math.min(low, least[2]), Math.max(high, most[2])];
      return false;
    });
    return [low, high];
  };
  assert.deepEqual(within([0, 0, 100, 100]), [0, 95]);
  assert.deepEqual(within([190, 0, 201, 1]), [0, 2000], 'a void may be ground of any height');
  const [low, high] = within([10, 10, 11, 11]);
  assert.ok(low <= 7 && low > 6 && high >= 7.7 && high < 9, `${low} ${high}: of a large triangle what lies in the cell`);
  assert.deepEqual(within([49, 49, 51, 51]), [7, 95]);
});

test('lowland is drawn higher than mountains', () => {
  const spread = (relief: number) => ({ low: 0, high: relief, least: 0, most: relief });
  const factors = [3000, 600, 60, 6].map((relief) => usualExaggeration(framed(0, relief), spread(relief)));
  assert.deepEqual(factors, [...factors].sort((a, b) => a - b));
  assert.ok(factors[0] === 1 && factors[3] > 4 && factors[3] <= 12, `${factors}`);
});
