// SPDX-License-Identifier: GPL-3.0-or-later
//
// The camera over the terrain, without a picture.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { PerspectiveCamera } from 'three';
import { Frame } from '../src/frame';
import { View } from '../src/view';

/** A view of a hilly terrain of some kilometres; `rest` draws until it rests, and returns the number of pictures. */
function viewed(): { view: View; rest: () => number } {
  Object.assign(globalThis, { matchMedia: () => ({ matches: false }) });
  const page = new EventTarget();
  const canvas = Object.assign(new EventTarget(), { style: {}, ownerDocument: page, getRootNode: () => page });
  const camera = new PerspectiveCamera(42, 1.5, 1, 1e6);
  camera.up.set(0, 0, 1);
  const view = new View(camera, canvas as unknown as HTMLCanvasElement);
  const facts = {
    originX: 500000, originY: 5000000, stepX: 30, stepY: 30, heightIsFloat: 0, heightStep: 1, heightOffset: 0, minX: 0, minY: 0,
    maxX: 256, maxY: 256, minHeight: 300, maxHeight: 1800, baseError: 0, baseDeviation: 0,
  };
  const earth = {
    isDegrees: false, lengths: { unit: 'metre', metres: 1 }, metresPerHeight: 1, curvature: 0, lightSpeed: 1, size: null,
    scales: [{ y: 5000000, x: 1, perY: 1 }],
  };
  view.setFrame(new Frame(facts, { horizontal: 'metre', height: 'metre' }, earth), 1100, 0);
  const ground = (x: number, y: number): number => 750 + 750 * Math.sin(x / 330) * Math.cos(y / 400);
  let hasChanged = false;
  view.controls.addEventListener('change', () => { hasChanged = true; });
  const rest = (): number => {
    for (let pictures = 1; pictures < 100; ++pictures) {
      hasChanged = false;
      if (!view.update(ground) && !hasChanged) return pictures;
    }
    return Infinity;
  };
  return { view, rest };
}

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
