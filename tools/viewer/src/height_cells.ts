// SPDX-License-Identifier: GPL-3.0-or-later
//
// Between which heights the surface lies in each cell of a coarse grid: what may be in the picture is told by them, where the
// heights of the whole terrain would let every cell up to the horizon be.
import type { Window } from 'ptin-decoder';
import type { Triple } from './space';
import { extentOf } from './triangle_grid';

/** Cells along each side. */
const across = 64;

export interface HeightCells {
  west: number;
  south: number;
  /** Of a cell. */
  width: number;
  depth: number;
  /** The least and the greatest z, row by row from the south; Infinity and -Infinity where there is no surface. */
  lows: Float32Array;
  highs: Float32Array;
}

/**
 * The surface's corners, and those of voids: where a mesh has a void, the terrain may have ground of any height up to `relief`.
 * Cost: linear in triangles and in the cells that they touch.
 */
export function heightCellsOf(positions: Float32Array, surface: Uint32Array, voids: Uint32Array, relief: number): HeightCells {
  const ends = [surface, voids].filter((c) => c.length > 0).map((c) => extentOf(positions, c));
  const west = Math.min(...ends.map((e) => e.west)), south = Math.min(...ends.map((e) => e.south));
  const east = Math.max(...ends.map((e) => e.east)), north = Math.max(...ends.map((e) => e.north));
  const cells: HeightCells = {
    west, south, width: Math.max((east - west) / across, 1e-6), depth: Math.max((north - south) / across, 1e-6),
    lows: new Float32Array(across * across).fill(Infinity), highs: new Float32Array(across * across).fill(-Infinity),
  };
  for (const [corners, range] of [[surface, null], [voids, [0, relief]]] as const) {
    for (let t = 0; t < corners.length; t += 3) addTriangle(cells, positions, 3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2], range);
  }
  return cells;
}

/** Whether `test` holds for the box of a cell's part within an extent. The surface there may be off by `slack`. */
export function someBox(
  { west, south, width, depth, lows, highs }: HeightCells, within: Window, slack: number, test: (least: Triple, most: Triple) => boolean,
): boolean {
  const [firstColumn, lastColumn] = cellsFrom((within[0] - west) / width, (within[2] - west) / width);
  const [firstRow, lastRow] = cellsFrom((within[1] - south) / depth, (within[3] - south) / depth);
  for (let row = firstRow; row <= lastRow; ++row) {
    for (let column = firstColumn; column <= lastColumn; ++column) {
      const cell = row * across + column;
      if (lows[cell] > highs[cell]) continue;
      const left = west + column * width, foot = south + row * depth;
      const least: Triple = [Math.max(left, within[0]), Math.max(foot, within[1]), lows[cell] - slack];
      const most: Triple = [Math.min(left + width, within[2]), Math.min(foot + depth, within[3]), highs[cell] + slack];
      if (test(least, most)) return true;
    }
  }
  return false;
}

/** The first and the last cell between two places, in cells. */
function cellsFrom(low: number, high: number): [first: number, last: number] {
  const cell = (at: number): number => Math.max(0, Math.min(across - 1, Math.floor(at)));
  return [cell(low), cell(high)];
}

/**
 * Widens the cells below a triangle by a range, or by what its plane has there: a long triangle of a slope is not as high everywhere
 * as its top.
 */
function addTriangle(
  { west, south, width, depth, lows, highs }: HeightCells, p: Float32Array, a: number, b: number, c: number,
  range: readonly [low: number, high: number] | null,
): void {
  const [low, high] = range ?? [Math.min(p[a + 2], p[b + 2], p[c + 2]), Math.max(p[a + 2], p[b + 2], p[c + 2])];
  const left = Math.min(p[a], p[b], p[c]), right = Math.max(p[a], p[b], p[c]);
  const foot = Math.min(p[a + 1], p[b + 1], p[c + 1]), top = Math.max(p[a + 1], p[b + 1], p[c + 1]);
  const [firstColumn, lastColumn] = cellsFrom((left - west) / width, (right - west) / width);
  const [firstRow, lastRow] = cellsFrom((foot - south) / depth, (top - south) / depth);
  const plane = range === null ? planeOf(p, a, b, c) : null;
  for (let row = firstRow; row <= lastRow; ++row) {
    for (let column = firstColumn; column <= lastColumn; ++column) {
      const cell = row * across + column;
      // Of the triangle's box the part in the cell.
      const [x0, x1] = [Math.max(left, west + column * width), Math.min(right, west + (column + 1) * width)];
      const [y0, y1] = [Math.max(foot, south + row * depth), Math.min(top, south + (row + 1) * depth)];
      if (plane !== null && isBeside(p, a, b, c, x0, y0, x1, y1)) continue;
      const there = plane === null ? [low, high] : [least(plane, x0, y0, x1, y1), -least(plane.map((v) => -v), x0, y0, x1, y1)];
      lows[cell] = Math.min(lows[cell], Math.max(low, there[0]));
      highs[cell] = Math.max(highs[cell], Math.min(high, there[1]));
    }
  }
}

/** z = plane[0] x + plane[1] y + plane[2] of a triangle; null where it stands on an edge. */
function planeOf(p: Float32Array, a: number, b: number, c: number): number[] | null {
  const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
  const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
  const area = ux * vy - uy * vx;
  if (!(area > 0)) return null;
  const east = (uz * vy - uy * vz) / area, north = (ux * vz - uz * vx) / area;
  return [east, north, p[a + 2] - east * p[a] - north * p[a + 1]];
}

/** The least of plane[0] x + plane[1] y + plane[2] in a rectangle. */
function least([east, north, base]: number[], x0: number, y0: number, x1: number, y1: number): number {
  return base + Math.min(east * x0, east * x1) + Math.min(north * y0, north * y1);
}

/** Whether a rectangle lies wholly to the right of an edge of a triangle that goes round to the left. */
function isBeside(p: Float32Array, a: number, b: number, c: number, x0: number, y0: number, x1: number, y1: number): boolean {
  for (const [from, to] of [[a, b], [b, c], [c, a]]) {
    const ex = p[to] - p[from], ey = p[to + 1] - p[from + 1];
    // The cross product with the rectangle's corner that lies farthest to the left.
    if (ex * ((ex > 0 ? y1 : y0) - p[from + 1]) - ey * ((ey > 0 ? x0 : x1) - p[from]) < 0) return true;
  }
  return false;
}
