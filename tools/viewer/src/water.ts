// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which triangles are water: a surface of triangles that are exactly horizontal, at height 0, or large and with higher ground around.
import type { Facts, MeshView } from 'ptin-decoder';
import { heightOf, none, triangleWords, vertexWords } from 'ptin-decoder/values';

export const land = 0, water = 1, isVoid = 2;

/** Shares of the terrain's area from which on a surface is water: at height 0, and at any other height. */
const leastSea = 1e-4, leastLake = 2e-3;
/** Around a lake at least this share of its border leads up. Plateaus of rounded heights lead down, too. */
const leastShore = 0.85;

/** For each triangle `land`, `water` or `isVoid`. Cost: linear. */
export function kindsOf(mesh: MeshView, facts: Facts): Uint8Array {
  const { triangleCount, classes, triangles, vertices } = mesh;
  const kinds = new Uint8Array(triangleCount);
  const level = levelTriangles(mesh);
  const whole = 2 * (facts.maxX - facts.minX) * (facts.maxY - facts.minY);
  for (let t = 0; t < triangleCount; ++t) {
    if (classes[t] !== 0) kinds[t] = isVoid;
    if (level[t] !== 1) continue;
    const surface = surfaceFrom(mesh, t, level, facts);
    const atZero = heightOf(facts, vertices[triangles[triangleWords * t] * vertexWords + 2]) === 0;
    const isWater = atZero ? surface.area > leastSea * whole : surface.area > leastLake * whole && surface.shore > leastShore;
    if (isWater) for (const member of surface.members) kinds[member] = water;
  }
  addShallows(mesh, facts, kinds);
  return kinds;
}

/** Shares of the terrain's length and of its relief: a triangle that is longer, and not higher above the water at its corner, is water. */
const longShallow = 0.012, highShallow = 0.03;
/** The same length of a triangle that touches only such water: from coast to coast across a sea. Marshes have shorter ones. */
const acrossSea = 0.06;
/** And of one with water on two sides, or on one and thin: a dam from coast to coast, which a real one is wider than, or has a crest. */
const asDam = 0.004;
/** The height of a thin triangle over its longest side, as a share of that. */
const thin = 0.12;
/** Times that such triangles are looked for behind each other. */
const mostSteps = 8;

/**
 * Between water and coast a coarse mesh has long triangles that rise by little: nearly all of what they cover is water. They become
 * so, too, the still longer ones that touch only them, and what is left between them.
 */
function addShallows(mesh: MeshView, facts: Facts, kinds: Uint8Array): void {
  const { vertices, triangles, triangleCount } = mesh;
  /** For each corner of water its level. */
  let levels = new Map<number, number>();
  for (let t = 0, at = 0; t < triangleCount; ++t, at += triangleWords) {
    if (kinds[t] !== water) continue;
    for (let k = 0; k < 3; ++k) levels.set(triangles[at + k], heightOf(facts, vertices[triangles[at] * vertexWords + 2]));
  }
  const whole = Math.hypot(facts.maxX - facts.minX, facts.maxY - facts.minY);
  for (let n = 0; levels.size > 0 && n < mostSteps; ++n) {
    levels = turned(mesh, facts, kinds, { levels, long: (n === 0 ? longShallow : acrossSea) * whole, dam: asDam * whole });
  }
}

/** Turns triangles at corners of water into water where they are long and shallow. Returns the levels of their corners. */
function turned(
  mesh: MeshView, facts: Facts, kinds: Uint8Array, from: { levels: ReadonlyMap<number, number>; long: number; dam: number },
): Map<number, number> {
  const { vertices, triangles, triangleCount } = mesh;
  const found = new Map<number, number>();
  const high = highShallow * (facts.maxHeight - facts.minHeight);
  for (let t = 0, at = 0; t < triangleCount; ++t, at += triangleWords) {
    if (kinds[t] !== land) continue;
    const corners = [triangles[at], triangles[at + 1], triangles[at + 2]];
    const level = corners.map((v) => from.levels.get(v)).find((l) => l !== undefined);
    if (level === undefined) continue;
    const mean = corners.reduce((sum, v) => sum + heightOf(facts, vertices[v * vertexWords + 2]), 0) / 3;
    const apart = (a: number, b: number): number =>
      Math.hypot(vertices[a * vertexWords] - vertices[b * vertexWords], vertices[a * vertexWords + 1] - vertices[b * vertexWords + 1]);
    const length = Math.max(apart(corners[0], corners[1]), apart(corners[1], corners[2]), apart(corners[2], corners[0]));
    if (length <= from.dam || Math.abs(mean - level) >= high) continue;
    const sides = [3, 4, 5].filter((k) => triangles[at + k] !== none && kinds[triangles[at + k]] === water).length;
    const isDam = sides > 1 || (sides > 0 && areaOf(mesh, t) < thin * length * length);
    if (!isDam && length <= from.long) continue;
    kinds[t] = water;
    for (const v of corners) found.set(v, level);
  }
  return found;
}

/** 1 for each triangle of the surface whose corners have one height. */
function levelTriangles({ triangleCount, vertices, triangles, classes }: MeshView): Uint8Array {
  const level = new Uint8Array(triangleCount);
  for (let t = 0, at = 0; t < triangleCount; ++t, at += triangleWords) {
    if (classes[t] !== 0) continue;
    const height = vertices[triangles[at] * vertexWords + 2];
    if (height === vertices[triangles[at + 1] * vertexWords + 2] && height === vertices[triangles[at + 2] * vertexWords + 2]) level[t] = 1;
  }
  return level;
}

/**
 * All level triangles that hang together with one, which become 2 in `level`; twice their area on the grid, and the share of their
 * border that leads up.
 */
function surfaceFrom(mesh: MeshView, first: number, level: Uint8Array, facts: Facts): { members: number[]; area: number; shore: number } {
  const { triangles, classes } = mesh;
  const members = [first];
  level[first] = 2;
  const height = heightOf(facts, mesh.vertices[triangles[triangleWords * first] * vertexWords + 2]);
  let area = 0, up = 0, border = 0;
  for (let i = 0; i < members.length; ++i) {
    area += areaOf(mesh, members[i]);
    for (let k = 3; k < triangleWords; ++k) {
      const across = triangles[triangleWords * members[i] + k];
      if (across === none || classes[across] !== 0 || level[across] === 2) continue;
      if (level[across] === 1) {
        level[across] = 2;
        members.push(across);
        continue;
      }
      ++border;
      if (farCorner(mesh, across, members[i], facts) > height) ++up;
    }
  }
  return { members, area, shore: border === 0 ? 0 : up / border };
}

function areaOf({ vertices: v, triangles }: MeshView, t: number): number {
  const a = vertexWords * triangles[triangleWords * t], b = vertexWords * triangles[triangleWords * t + 1];
  const c = vertexWords * triangles[triangleWords * t + 2];
  return (v[b] - v[a]) * (v[c + 1] - v[a + 1]) - (v[b + 1] - v[a + 1]) * (v[c] - v[a]);
}

/** The height of the corner that a triangle does not share with its neighbour. */
function farCorner({ vertices, triangles }: MeshView, t: number, neighbour: number, facts: Facts): number {
  for (let k = 0; k < 3; ++k) {
    if (triangles[triangleWords * t + 3 + k] !== neighbour) continue;
    return heightOf(facts, vertices[triangles[triangleWords * t + k] * vertexWords + 2]);
  }
  return NaN;
}
