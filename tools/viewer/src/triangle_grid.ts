// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which triangles of the picture lie where, so that a place under the pointer and the ground below the camera are found without
// the card. For pictures alone: heights that are told come from the engine.
import type { Triple } from './space';

/** Squares over the terrain; the triangles that may touch square s are `triangles[starts[s]]` up to `triangles[starts[s + 1]]`. */
export interface TriangleGrid {
  west: number;
  south: number;
  size: number;
  columns: number;
  rows: number;
  starts: Uint32Array;
  /** Each the place of its first corner in the corners. */
  triangles: Uint32Array;
}

/** Squares along the longer side, at most: with a few triangles in each. */
const mostColumns = 512;

/** Cost: linear in triangles and in the squares that they touch. */
export function gridOf(positions: Float32Array, corners: Uint32Array): TriangleGrid {
  const { west, south, east, north } = extentOf(positions, corners);
  const wanted = Math.min(mostColumns, Math.max(1, Math.ceil(Math.sqrt(corners.length / 6))));
  const size = Math.max(east - west, north - south, 1e-6) / wanted;
  const columns = Math.floor((east - west) / size) + 1, rows = Math.floor((north - south) / size) + 1;
  const grid = { west, south, size, columns, rows, starts: new Uint32Array(columns * rows + 1), triangles: new Uint32Array(0) };
  const { starts } = grid;
  eachSquare(grid, positions, corners, (square) => { ++starts[square + 1]; });
  for (let s = 1; s < starts.length; ++s) starts[s] += starts[s - 1];
  grid.triangles = new Uint32Array(starts[starts.length - 1]);
  const next = starts.slice();
  eachSquare(grid, positions, corners, (square, t) => { grid.triangles[next[square]++] = t; });
  return grid;
}

export function extentOf(positions: Float32Array, corners: Uint32Array): { west: number; south: number; east: number; north: number } {
  let west = Infinity, south = Infinity, east = -Infinity, north = -Infinity;
  for (const v of corners) {
    const x = positions[3 * v], y = positions[3 * v + 1];
    if (x < west) west = x;
    if (x > east) east = x;
    if (y < south) south = y;
    if (y > north) north = y;
  }
  return east >= west ? { west, south, east, north } : { west: 0, south: 0, east: 0, north: 0 };
}

function eachSquare(g: TriangleGrid, p: Float32Array, corners: Uint32Array, tell: (square: number, t: number) => void): void {
  const { west, south, size, columns } = g;
  for (let t = 0; t < corners.length; t += 3) {
    const a = 3 * corners[t], b = 3 * corners[t + 1], c = 3 * corners[t + 2];
    const firstColumn = Math.floor((Math.min(p[a], p[b], p[c]) - west) / size);
    const lastColumn = Math.floor((Math.max(p[a], p[b], p[c]) - west) / size);
    const firstRow = Math.floor((Math.min(p[a + 1], p[b + 1], p[c + 1]) - south) / size);
    const lastRow = Math.floor((Math.max(p[a + 1], p[b + 1], p[c + 1]) - south) / size);
    for (let row = firstRow; row <= lastRow; ++row) {
      for (let column = firstColumn; column <= lastColumn; ++column) tell(row * columns + column, t);
    }
  }
}

/** The triangles of a mesh as rays and plumb lines meet them. */
export class Ground {
  constructor(
    private readonly positions: Float32Array, private readonly corners: Uint32Array, private readonly grid: TriangleGrid,
  ) {}

  /** z at a place of the scene; null where there is no triangle. Cost: the triangles of a square. */
  at(x: number, y: number): number | null {
    const { grid, positions: p, corners } = this;
    const column = Math.floor((x - grid.west) / grid.size), row = Math.floor((y - grid.south) / grid.size);
    if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) return null;
    const square = row * grid.columns + column;
    let highest: number | null = null;
    for (let i = grid.starts[square]; i < grid.starts[square + 1]; ++i) {
      const t = grid.triangles[i];
      const z = heightIn(p, 3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2], x, y);
      if (z !== null && (highest === null || z > highest)) highest = z;
    }
    return highest;
  }

  /** The share of `way` from `from` at which the ground is met first; null where it is not. Cost: the squares below the way. */
  meets(from: Triple, way: Triple): number | null {
    const { grid } = this;
    const [begin, end] = this.shareOver(from, way);
    if (begin > end) return null;
    const clamp = (i: number, count: number): number => Math.max(0, Math.min(count - 1, i));
    let column = clamp(Math.floor((from[0] + begin * way[0] - grid.west) / grid.size), grid.columns);
    let row = clamp(Math.floor((from[1] + begin * way[1] - grid.south) / grid.size), grid.rows);
    for (;;) {
      // The ray leaves the square at the nearer of its two far sides.
      const acrossX = way[0] === 0 ? Infinity : (grid.west + (column + (way[0] > 0 ? 1 : 0)) * grid.size - from[0]) / way[0];
      const acrossY = way[1] === 0 ? Infinity : (grid.south + (row + (way[1] > 0 ? 1 : 0)) * grid.size - from[1]) / way[1];
      const leaves = Math.min(acrossX, acrossY);
      const met = this.metIn(row * grid.columns + column, from, way);
      if (met !== null && met <= leaves * (1 + 1e-9) + 1e-9) return met;
      if (leaves >= end || leaves === Infinity) return met;
      if (acrossX < acrossY) column += Math.sign(way[0]);
      else row += Math.sign(way[1]);
      if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) return met;
    }
  }

  /** Between which shares the way is over the grid. */
  private shareOver(from: Triple, way: Triple): [begin: number, end: number] {
    const { west, south, size, columns, rows } = this.grid;
    let begin = 0, end = Infinity;
    for (const [i, low, high] of [[0, west, west + columns * size], [1, south, south + rows * size]] as const) {
      if (way[i] === 0) {
        if (from[i] < low || from[i] > high) return [1, 0];
        continue;
      }
      const one = (low - from[i]) / way[i], other = (high - from[i]) / way[i];
      begin = Math.max(begin, Math.min(one, other));
      end = Math.min(end, Math.max(one, other));
    }
    return [begin, end];
  }

  private metIn(square: number, from: Triple, way: Triple): number | null {
    const { grid, positions: p, corners } = this;
    let first: number | null = null;
    for (let i = grid.starts[square]; i < grid.starts[square + 1]; ++i) {
      const t = grid.triangles[i];
      const share = shareTo(p, 3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2], from, way);
      if (share !== null && (first === null || share < first)) first = share;
    }
    return first;
  }
}

function heightIn(p: Float32Array, a: number, b: number, c: number, x: number, y: number): number | null {
  const area = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
  if (area === 0) return null;
  const u = ((p[b] - x) * (p[c + 1] - y) - (p[b + 1] - y) * (p[c] - x)) / area;
  const v = ((p[c] - x) * (p[a + 1] - y) - (p[c + 1] - y) * (p[a] - x)) / area;
  const w = 1 - u - v;
  const slack = -1e-5;
  return u < slack || v < slack || w < slack ? null : u * p[a + 2] + v * p[b + 2] + w * p[c + 2];
}

/** The share of a ray to a triangle, from either side (Moeller and Trumbore). */
function shareTo(p: Float32Array, a: number, b: number, c: number, from: Triple, way: Triple): number | null {
  const ex = p[b] - p[a], ey = p[b + 1] - p[a + 1], ez = p[b + 2] - p[a + 2];
  const fx = p[c] - p[a], fy = p[c + 1] - p[a + 1], fz = p[c + 2] - p[a + 2];
  const hx = way[1] * fz - way[2] * fy, hy = way[2] * fx - way[0] * fz, hz = way[0] * fy - way[1] * fx;
  const volume = ex * hx + ey * hy + ez * hz;
  if (volume === 0) return null;
  const sx = from[0] - p[a], sy = from[1] - p[a + 1], sz = from[2] - p[a + 2];
  const u = (sx * hx + sy * hy + sz * hz) / volume;
  if (u < -1e-5 || u > 1 + 1e-5) return null;
  const qx = sy * ez - sz * ey, qy = sz * ex - sx * ez, qz = sx * ey - sy * ex;
  const v = (way[0] * qx + way[1] * qy + way[2] * qz) / volume;
  if (v < -1e-5 || u + v > 1 + 2e-5) return null;
  const share = (fx * qx + fy * qy + fz * qz) / volume;
  return share > 0 ? share : null;
}
