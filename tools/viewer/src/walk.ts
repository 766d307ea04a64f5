// SPDX-License-Identifier: GPL-3.0-or-later
//
// Questions to the mesh that is there: the height at a point, along a line, and what a line of sight meets. Positions are on
// the grid; numbers are doubles, so places are off by some 2^-50 of the terrain's extent.
import { Facts, MeshView, none, triangleWords, vertexWords } from './decoder';
import { Frame, heightOf } from './frame';

export type PointState = 'surface' | 'void' | 'outside';

export interface Corner {
  x: number;
  y: number;
  /** In the height's unit; null where the vertex has none. */
  height: number | null;
}

export interface Located {
  state: PointState;
  /** Null unless the state is surface. */
  height: number | null;
  triangle: Corner[];
}

interface Grid {
  x: number;
  y: number;
}

function xOf(mesh: MeshView, v: number): number { return mesh.vertices[v * vertexWords]; }
function yOf(mesh: MeshView, v: number): number { return mesh.vertices[v * vertexWords + 1]; }

/** Twice the area of a, b, p: positive to the left of a, b. */
function side(mesh: MeshView, a: number, b: number, p: Grid): number {
  const ax = xOf(mesh, a), ay = yOf(mesh, a);
  return (xOf(mesh, b) - ax) * (p.y - ay) - (yOf(mesh, b) - ay) * (p.x - ax);
}

/** The edge of triangle t that has p on its outer side, farthest; -1 when t holds p. */
function outerEdge(mesh: MeshView, t: number, p: Grid): number {
  let edge = -1;
  let farthest = 0;
  for (let i = 0; i < 3; ++i) {
    const at = t * triangleWords;
    const s = side(mesh, mesh.triangles[at + (i + 1) % 3], mesh.triangles[at + (i + 2) % 3], p);
    if (s < farthest) {
      farthest = s;
      edge = i;
    }
  }
  return edge;
}

/** A triangle that holds p; `none` outside. Walks from `start`; cost: the triangles in between, at worst all. */
export function triangleAt(mesh: MeshView, p: Grid, start = 0): number {
  let t = start < mesh.triangleCount ? start : 0;
  const most = 64 + 8 * Math.ceil(Math.sqrt(mesh.triangleCount));
  for (let step = 0; step < most; ++step) {
    const edge = outerEdge(mesh, t, p);
    if (edge < 0) return preferred(mesh, t, p);
    const next = mesh.triangles[t * triangleWords + 3 + edge];
    if (next === none) break;
    t = next;
  }
  // The walk left a border that bends inwards, or went in a circle.
  for (t = 0; t < mesh.triangleCount; ++t) {
    if (outerEdge(mesh, t, p) < 0) return preferred(mesh, t, p);
  }
  return none;
}

/** Of the triangles that hold p, a surface one before a void one. */
function preferred(mesh: MeshView, t: number, p: Grid): number {
  if (mesh.classes[t] === 0) return t;
  for (let i = 0; i < 3; ++i) {
    const next = mesh.triangles[t * triangleWords + 3 + i];
    if (next !== none && mesh.classes[next] === 0 && outerEdge(mesh, next, p) < 0) return next;
  }
  return t;
}

function vertexHeight(mesh: MeshView, facts: Facts, v: number): number {
  return heightOf(facts, mesh.vertices[v * vertexWords + 2]);
}

/** The height of the plane of surface triangle t at p. */
function planeHeight(mesh: MeshView, facts: Facts, t: number, p: Grid): number {
  const corners = mesh.triangles.subarray(t * triangleWords, t * triangleWords + 3);
  let sum = 0;
  let area = 0;
  for (let i = 0; i < 3; ++i) {
    const weight = side(mesh, corners[(i + 1) % 3], corners[(i + 2) % 3], p);
    sum += weight * vertexHeight(mesh, facts, corners[i]);
    area += weight;
  }
  return sum / area;
}

/** What is at a position of the grid. */
export function locate(mesh: MeshView, facts: Facts, p: Grid, start = 0): Located {
  const t = triangleAt(mesh, p, start);
  if (t === none) return { state: 'outside', height: null, triangle: [] };
  const triangle = [0, 1, 2].map((i) => {
    const v = mesh.triangles[t * triangleWords + i];
    return { x: xOf(mesh, v), y: yOf(mesh, v), height: mesh.hasHeight[v] !== 0 ? vertexHeight(mesh, facts, v) : null };
  });
  if (mesh.classes[t] !== 0) return { state: 'void', height: null, triangle };
  return { state: 'surface', height: planeHeight(mesh, facts, t, p), triangle };
}

/** A stretch of a line over one surface triangle: shares of the way, and heights there. */
export interface Stretch {
  from: number;
  to: number;
  heightFrom: number;
  heightTo: number;
}

/**
 * The line from a to b over the surface, triangle by triangle; voids and the outside are gaps. A line that leaves a terrain
 * whose border bends inwards is followed into it again. Cost: the triangles crossed.
 */
export function stretches(mesh: MeshView, facts: Facts, a: Grid, b: Grid): Stretch[] {
  const all: Stretch[] = [];
  const at = (s: number): Grid => ({ x: a.x + s * (b.x - a.x), y: a.y + s * (b.y - a.y) });
  let share = 0;
  let t = triangleAt(mesh, a);
  let came = none;
  for (let steps = 0; share < 1 && steps < 4 * mesh.triangleCount + 4; ++steps) {
    if (t === none) {
      share = entrance(mesh, a, b, share);
      if (share >= 1) break;
      t = triangleAt(mesh, at(share + 1e-12));
      came = none;
      if (t === none) share += 1e-9;
      continue;
    }
    const exit = exitOf(mesh, t, came, a, b);
    const to = Math.min(1, Math.max(share, exit.share));
    if (mesh.classes[t] === 0 && to > share) {
      all.push({
        from: share, to, heightFrom: planeHeight(mesh, facts, t, at(share)), heightTo: planeHeight(mesh, facts, t, at(to)),
      });
    }
    share = to;
    came = t;
    t = exit.next;
  }
  return all;
}

/** Where the line leaves triangle t, and for which; not back through the edge through which it came. */
function exitOf(mesh: MeshView, t: number, came: number, a: Grid, b: Grid): { share: number; next: number } {
  const at = t * triangleWords;
  let exit = { share: Infinity, next: none };
  for (let i = 0; i < 3; ++i) {
    const next = mesh.triangles[at + 3 + i];
    if (next === came && came !== none) continue;
    const from = mesh.triangles[at + (i + 1) % 3], to = mesh.triangles[at + (i + 2) % 3];
    const first = side(mesh, from, to, a);
    const last = side(mesh, from, to, b);
    if (last >= first) continue;
    const share = first / (first - last);
    if (share < exit.share) exit = { share, next };
  }
  return exit;
}

/** The first share of the way beyond `share` at which the line crosses the border inwards; 1 when there is none. */
function entrance(mesh: MeshView, a: Grid, b: Grid, share: number): number {
  let first = 1;
  for (let t = 0; t < mesh.triangleCount; ++t) {
    const at = t * triangleWords;
    for (let i = 0; i < 3; ++i) {
      if (mesh.triangles[at + 3 + i] !== none) continue;
      const from = mesh.triangles[at + (i + 1) % 3], to = mesh.triangles[at + (i + 2) % 3];
      const begin = side(mesh, from, to, a), end = side(mesh, from, to, b);
      if (begin >= 0 || end <= begin) continue;
      const crossing = begin / (begin - end);
      const x = a.x + crossing * (b.x - a.x) - xOf(mesh, from), y = a.y + crossing * (b.y - a.y) - yOf(mesh, from);
      const ex = xOf(mesh, to) - xOf(mesh, from), ey = yOf(mesh, to) - yOf(mesh, from);
      const along = (x * ex + y * ey) / (ex * ex + ey * ey);
      if (crossing > share && crossing < first && along >= 0 && along <= 1) first = crossing;
    }
  }
  return first;
}

export interface SightRequest {
  /** Above ground, in metres. */
  observerHeight: number;
  targetHeight: number;
  /** In hertz; 0: no Fresnel zone. */
  frequency: number;
}

/** What is between the two ends. Heights and distances in metres of the scene. */
export interface Sight {
  /** `unsure`: what the mesh leaves out could turn the answer. */
  verdict: 'visible' | 'hidden' | 'unsure';
  /** Of the line above the ground, where it is least; at the ends that is the height of the eye, or of the target. */
  clearance: number;
  /** Share of the way at which that is. */
  clearanceAt: number;
  /** Least clearance in radii of the first Fresnel zone; null without a frequency. */
  fresnelRatio: number | null;
  fresnelAt: number;
  length: number;
  /** Absolute, of the two ends of the line. */
  observerZ: number;
  targetZ: number;
}

/** Curvature as the engine has it: 1 less 1/7 for refraction, over the Earth's diameter. */
const curvature = 0.85714 / (2 * 6378137);
const speedOfLight = 299792458;

/** How far the straight line hangs above the curved Earth's chord at a share of its way: negative in between. */
export function curvatureDrop(length: number, share: number): number {
  return curvature * length * length * share * (share - 1);
}

export function fresnelRadius(frequency: number, length: number, share: number): number {
  return Math.sqrt(Math.max(0, (speedOfLight / frequency) * length * share * (1 - share)));
}

/**
 * Whether one end of the line sees the other. `uncertainty`: bound of the deviation of the mesh, in metres; it counts at the
 * ends' ground and in between. Voids do not obstruct. Null when an end has no ground.
 */
export function sight(line: Stretch[], length: number, scaleZ: number, request: SightRequest, uncertainty: number): Sight | null {
  const first = line[0], last = line[line.length - 1];
  if (first === undefined || first.from > 1e-9 || last.to < 1 - 1e-9) return null;
  const observerZ = first.heightFrom * scaleZ + request.observerHeight;
  const targetZ = last.heightTo * scaleZ + request.targetHeight;
  const answer: Sight = {
    verdict: 'visible', clearance: Infinity, clearanceAt: 0, fresnelRatio: request.frequency > 0 ? Infinity : null,
    fresnelAt: 0, length, observerZ, targetZ,
  };
  // At its ends the line stands on the ground itself, however uncertain that is.
  let between = Infinity;
  const see = (share: number, ground: number): void => {
    const clearance = observerZ + share * (targetZ - observerZ) + curvatureDrop(length, share) - ground;
    if (clearance < answer.clearance) Object.assign(answer, { clearance, clearanceAt: share });
    if (share <= 0 || share >= 1) return;
    between = Math.min(between, clearance);
    if (answer.fresnelRatio === null) return;
    const ratio = clearance / fresnelRadius(request.frequency, length, share);
    if (ratio < answer.fresnelRatio) Object.assign(answer, { fresnelRatio: ratio, fresnelAt: share });
  };
  for (const s of line) {
    for (const share of candidates(s, observerZ, targetZ, scaleZ, length)) {
      const part = (share - s.from) / (s.to - s.from);
      see(share, scaleZ * (s.heightFrom + part * (s.heightTo - s.heightFrom)));
    }
  }
  // Both ends stand on ground that is as uncertain as what lies between: twice the bound.
  if (between < 0) answer.verdict = 'hidden';
  if (Math.abs(between) < 2 * uncertainty) answer.verdict = 'unsure';
  return answer;
}

/** Shares at which the clearance over a stretch may be least: its ends, where its parabola turns, and some in between. */
function candidates(s: Stretch, observerZ: number, targetZ: number, scaleZ: number, length: number): number[] {
  const slope = scaleZ * (s.heightTo - s.heightFrom) / (s.to - s.from);
  const bend = curvature * length * length;
  const turn = 0.5 + (slope - (targetZ - observerZ)) / (2 * bend);
  const shares = [s.from, s.to, (s.from + s.to) / 2];
  if (turn > s.from && turn < s.to) shares.push(turn);
  return shares;
}

/** A height with its place on the way, in metres; null: a gap begins. */
export interface Station {
  distance: number;
  height: number | null;
}

/** A line's stretches as one line of stations, with a null where it is broken. */
export function stationsOf(line: Stretch[], length: number): Station[] {
  const stations: Station[] = [];
  let before = -1;
  for (const s of line) {
    if (stations.length === 0 || s.from > before + 1e-9) {
      if (stations.length !== 0) stations.push({ distance: before * length, height: null });
      stations.push({ distance: s.from * length, height: s.heightFrom });
    }
    stations.push({ distance: s.to * length, height: s.heightTo });
    before = s.to;
  }
  return stations;
}

/** The line between two places of the map, walked on the mesh. */
export function lineOver(mesh: MeshView, frame: Frame, a: Grid, b: Grid): { line: Stretch[]; length: number } {
  const grid = (p: Grid): Grid => ({ x: frame.gridX(p.x), y: frame.gridY(p.y) });
  return { line: stretches(mesh, frame.facts, grid(a), grid(b)), length: frame.metresBetween(a, b) };
}
