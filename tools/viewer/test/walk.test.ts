// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights, profiles and lines of sight on the mesh that is shown, against the program's on the same mesh.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { test } from 'node:test';
import { Frame, unitsOf } from '../src/frame';
import { lineOver, locate, sight, stationsOf, stretches } from '../src/walk';
import { heightAlong } from '../src/plot';
import { decoded, decoderModule, file, ptin, terrain } from './support';

const error = '5';
const { store, stream } = terrain('mountains_257', '--error', error);
const decoder = decoded(decoderModule(), readFileSync(stream));
const { mesh, facts } = decoder;
const frame = new Frame(facts, unitsOf(JSON.parse(decoder.metadata)));

/** Places all over the terrain, and a little beyond. */
function place(i: number): { x: number; y: number } {
  const share = (n: number): number => (n * 0.6180339887498949) % 1;
  const west = frame.mapOfGridX(facts.minX), south = frame.mapOfGridY(facts.minY);
  return {
    x: Math.round(10 * (west + (1.02 * share(i) - 0.01) * (frame.mapOfGridX(facts.maxX) - west))) / 10,
    y: Math.round(10 * (south + (1.02 * share(i * 7.31) - 0.01) * (frame.mapOfGridY(facts.maxY) - south))) / 10,
  };
}

test('heights are those of locate at the same error', () => {
  const places = Array.from({ length: 60 }, (_, i) => place(i));
  writeFileSync(file('places.csv'), `x,y\n${places.map((at) => `${at.x},${at.y}\n`).join('')}`);
  const locateAll = (...options: string[]) =>
    (JSON.parse(ptin('locate', store, '--points', file('places.csv'), ...options, '--json')) as
      { points: Array<{ state: string; height: number | null }> }).points;
  const told = locateAll('--error', error), exact = locateAll();
  for (const [i, at] of places.entries()) {
    const point = told[i];
    const here = locate(mesh, facts, { x: frame.gridX(at.x), y: frame.gridY(at.y) });
    assert.equal(here.state, point.state);
    if (point.height === null || here.height === null) continue;
    // The engine rounds places to 2^-22 of a grid unit.
    assert.ok(Math.abs(here.height - point.height) < 1e-5, `${here.height} for ${point.height}`);
    const d = decoder.certificate.deviation;
    const full = exact[i].height as number;
    assert.ok(Math.abs(full - here.height) <= d + 1e-9, 'the full terrain is within the certificate');
  }
});

test('profiles are those of the program', () => {
  for (let i = 0; i < 12; ++i) {
    const a = place(2 * i), b = place(2 * i + 1);
    const told = JSON.parse(ptin(
      'profile', store, '--line', `LINESTRING(${a.x} ${a.y}, ${b.x} ${b.y})`, '--error', error, '--json')) as
      { points: Array<{ distance: number; height: number | null }> };
    const { line, length } = lineOver(mesh, frame, a, b);
    const stations = stationsOf(line, length);
    for (const p of told.points) {
      if (p.height === null || p.distance < 1e-3 || p.distance > length - 1e-3) continue;
      const here = heightAlong(stations, p.distance);
      assert.ok(here !== null && Math.abs(here - p.height) < 1e-5, `${here} for ${p.height} at ${p.distance}`);
    }
  }
});

test('a profile has no gap where there is none, and goes the whole way', () => {
  for (let i = 0; i < 300; ++i) {
    const inside = (n: number): number => 1 + Math.round(254 * ((n * 0.754877666) % 1));
    const a = { x: inside(i), y: inside(3 * i) }, b = { x: inside(5 * i + 1), y: inside(7 * i + 2) };
    if (a.x === b.x && a.y === b.y) continue;
    const scale = (facts.maxX - facts.minX) / 256;
    const line = stretches(mesh, facts, { x: a.x * scale, y: a.y * scale }, { x: b.x * scale, y: b.y * scale });
    assert.ok(line[0].from === 0 && Math.abs(line[line.length - 1].to - 1) < 1e-12, `line ${i}`);
    for (let k = 1; k < line.length; ++k) {
      assert.ok(Math.abs(line[k].from - line[k - 1].to) < 1e-12);
      assert.ok(Math.abs(line[k].heightFrom - line[k - 1].heightTo) < 1e-6);
    }
  }
});

test('lines of sight are those of the program', () => {
  let hidden = 0;
  for (let i = 0; i < 25; ++i) {
    const a = place(3 * i + 1), b = place(3 * i + 2);
    const told = JSON.parse(ptin(
      'sight', store, String(a.x), String(a.y), '20', String(b.x), String(b.y), '30', '--frequency', '450MHz', '--error', error,
      '--json')) as { verdict: string; clearance: { min: number; max: number } | null; fresnel: { ratio: number } | null };
    const { line, length } = lineOver(mesh, frame, a, b);
    const here = sight(line, length, 1, { observerHeight: 20, targetHeight: 30, frequency: 450e6 }, decoder.certificate.deviation);
    if (here === null || told.clearance === null) continue;
    // The ground may be off below the line, and below an end by which the line is raised.
    const off = 2 * decoder.certificate.deviation + 1e-6;
    assert.ok(here.clearance >= told.clearance.min - off && here.clearance <= told.clearance.max + off,
      `${here.clearance} within ${off} of [${told.clearance.min}, ${told.clearance.max}]`);
    // A verdict that the certificate allows is one that the program may not contradict.
    if (here.verdict !== 'unsure') assert.ok(told.verdict.endsWith(here.verdict), `${told.verdict} for ${here.verdict}`);
    hidden += here.verdict === 'hidden' ? 1 : 0;
  }
  assert.ok(hidden > 3);
});
