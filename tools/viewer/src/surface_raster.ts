// SPDX-License-Identifier: GPL-3.0-or-later
//
// The land as a coarse raster: how its heights are spread over its area, and what lies below or above what is around it, of which
// hollows are shaded and ridges lit.
import { extentOf } from './triangle_grid';

/** Squares along the longer side. */
const mostColumns = 256;
/** Sizes of the neighbourhoods that a place is held against, in squares. */
const nearRadius = 3, farRadius = 14;

/** Heights of the land, by area; scene z. Outliers are too few to matter. */
export interface Spread {
  /** At 2 and 98 percent: for colours. */
  low: number;
  high: number;
  /** At a half and 99.5 percent: for the relief as a whole. */
  least: number;
  most: number;
}

export class SurfaceRaster {
  private readonly west: number;
  private readonly south: number;
  private readonly size: number;
  private readonly columns: number;
  private readonly rows: number;
  /** At the middle of each square; NaN where there is no land. */
  private readonly heights: Float32Array;

  /** Cost: linear in triangles and in squares. */
  constructor(positions: Float32Array, corners: Uint32Array) {
    const { west, south, east, north } = extentOf(positions, corners);
    this.west = west;
    this.south = south;
    this.size = Math.max(east - west, north - south, 1e-6) / mostColumns;
    this.columns = Math.max(1, Math.ceil((east - west) / this.size));
    this.rows = Math.max(1, Math.ceil((north - south) / this.size));
    this.heights = new Float32Array(this.columns * this.rows).fill(NaN);
    for (let t = 0; t < corners.length; t += 3) this.fill(positions, 3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2]);
  }

  /** Null where there is no land. */
  get spread(): Spread | null {
    const known = this.heights.filter((z) => !Number.isNaN(z)).sort();
    if (known.length === 0) return null;
    const at = (share: number): number => known[Math.round(share * (known.length - 1))];
    return { low: at(0.02), high: at(0.98), least: at(0.005), most: at(0.995) };
  }

  /** For each vertex how it lies: -1 in a hollow to 1 on a ridge. */
  openness(positions: Float32Array): Float32Array {
    const near = this.above(nearRadius), far = this.above(farRadius);
    const open = new Float32Array(positions.length / 3);
    for (let v = 0; v < open.length; ++v) {
      const x = (positions[3 * v] - this.west) / this.size - 0.5, y = (positions[3 * v + 1] - this.south) / this.size - 0.5;
      open[v] = Math.max(-1, Math.min(1, 0.5 * this.between(near, x, y) + 0.7 * this.between(far, x, y)));
    }
    return open;
  }

  /** Sets the squares whose middle lies in a triangle. */
  private fill(p: Float32Array, a: number, b: number, c: number): void {
    const { west, south, size } = this;
    const area = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
    if (!(area > 0)) return;
    const column = (x: number): number => (x - west) / size - 0.5, row = (y: number): number => (y - south) / size - 0.5;
    const left = Math.ceil(column(Math.min(p[a], p[b], p[c]))), right = Math.floor(column(Math.max(p[a], p[b], p[c])));
    const low = Math.ceil(row(Math.min(p[a + 1], p[b + 1], p[c + 1]))), high = Math.floor(row(Math.max(p[a + 1], p[b + 1], p[c + 1])));
    for (let j = Math.max(0, low); j <= Math.min(this.rows - 1, high); ++j) {
      for (let i = Math.max(0, left); i <= Math.min(this.columns - 1, right); ++i) {
        const x = west + (i + 0.5) * size, y = south + (j + 0.5) * size;
        const u = ((p[b] - x) * (p[c + 1] - y) - (p[b + 1] - y) * (p[c] - x)) / area;
        const v = ((p[c] - x) * (p[a + 1] - y) - (p[c + 1] - y) * (p[a] - x)) / area;
        if (u < 0 || v < 0 || u + v > 1) continue;
        this.heights[j * this.columns + i] = u * p[a + 2] + v * p[b + 2] + (1 - u - v) * p[c + 2];
      }
    }
  }

  /** How far each square is above the mean of those around, in twice the usual distance from it. */
  private above(radius: number): Float32Array {
    const means = this.means(radius);
    const above = new Float32Array(means.length);
    let squares = 0, known = 0;
    for (let i = 0; i < above.length; ++i) {
      const difference = this.heights[i] - means[i];
      if (Number.isNaN(difference)) continue;
      above[i] = difference;
      squares += difference * difference;
      ++known;
    }
    const usual = 2 * Math.sqrt(squares / Math.max(1, known)) || 1;
    for (let i = 0; i < above.length; ++i) above[i] = Math.max(-1, Math.min(1, above[i] / usual));
    return above;
  }

  /** Means of squares of squares, by sums of all that lies west and south. */
  private means(radius: number): Float32Array {
    const { columns, rows, heights } = this;
    const wide = columns + 1;
    const sums = new Float64Array(wide * (rows + 1)), counts = new Float64Array(sums.length);
    for (let j = 0; j < rows; ++j) {
      for (let i = 0; i < columns; ++i) {
        const z = heights[j * columns + i], at = (j + 1) * wide + i + 1;
        const known = Number.isNaN(z) ? 0 : 1;
        sums[at] = sums[at - 1] + sums[at - wide] - sums[at - wide - 1] + (known === 0 ? 0 : z);
        counts[at] = counts[at - 1] + counts[at - wide] - counts[at - wide - 1] + known;
      }
    }
    const means = new Float32Array(columns * rows);
    for (let j = 0; j < rows; ++j) {
      const top = Math.min(rows, j + radius + 1) * wide, foot = Math.max(0, j - radius) * wide;
      for (let i = 0; i < columns; ++i) {
        const right = Math.min(columns, i + radius + 1), left = Math.max(0, i - radius);
        const of = (all: Float64Array): number => all[top + right] - all[top + left] - all[foot + right] + all[foot + left];
        means[j * columns + i] = of(sums) / of(counts);
      }
    }
    return means;
  }

  private between(values: Float32Array, x: number, y: number): number {
    const i = Math.max(0, Math.min(this.columns - 2, Math.floor(x))), j = Math.max(0, Math.min(this.rows - 2, Math.floor(y)));
    if (this.columns < 2 || this.rows < 2) return 0;
    const u = Math.max(0, Math.min(1, x - i)), v = Math.max(0, Math.min(1, y - j));
    const at = j * this.columns + i;
    return (1 - v) * ((1 - u) * values[at] + u * values[at + 1]) + v * ((1 - u) * values[at + this.columns] + u * values[at + this.columns + 1]);
  }
}
