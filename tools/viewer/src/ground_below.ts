// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ground of the picture below the camera, so that the camera stays out of it. For pictures alone: heights that are told come
// from the engine.
import type { DrawnMesh } from './drawn_mesh';

export class GroundBelow {
  /** Triangles that may be below the places of a square, the last that was asked for. */
  private near: number[] = [];
  private square: readonly [x: number, y: number] = [Infinity, Infinity];

  /** @param size  Of squares: some hundredth of the terrain. */
  constructor(private readonly mesh: DrawnMesh, private readonly size: number) {}

  /** z at a place of the scene; null where there is no triangle. Cost: as many triangles as there are when it comes to another square. */
  at(x: number, y: number): number | null {
    const square = [Math.floor(x / this.size), Math.floor(y / this.size)] as const;
    if (square[0] !== this.square[0] || square[1] !== this.square[1]) {
      this.square = square;
      this.near = this.trianglesOf(square);
    }
    let highest: number | null = null;
    for (const t of this.near) {
      const z = this.heightIn(t, x, y);
      if (z !== null && (highest === null || z > highest)) highest = z;
    }
    return highest;
  }

  private trianglesOf([column, row]: readonly [number, number]): number[] {
    const { positions: p, corners } = this.mesh;
    const west = column * this.size, east = west + this.size, south = row * this.size, north = south + this.size;
    const found: number[] = [];
    for (let t = 0; t < corners.length; t += 3) {
      const a = 3 * corners[t], b = 3 * corners[t + 1], c = 3 * corners[t + 2];
      if (p[a] < west && p[b] < west && p[c] < west || p[a] > east && p[b] > east && p[c] > east) continue;
      if (p[a + 1] < south && p[b + 1] < south && p[c + 1] < south || p[a + 1] > north && p[b + 1] > north && p[c + 1] > north) continue;
      found.push(t);
    }
    return found;
  }

  private heightIn(t: number, x: number, y: number): number | null {
    const { positions: p, corners } = this.mesh;
    const a = 3 * corners[t], b = 3 * corners[t + 1], c = 3 * corners[t + 2];
    const area = (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
    if (area === 0) return null;
    const u = ((p[b] - x) * (p[c + 1] - y) - (p[b + 1] - y) * (p[c] - x)) / area;
    const v = ((p[c] - x) * (p[a + 1] - y) - (p[c + 1] - y) * (p[a] - x)) / area;
    const w = 1 - u - v;
    const slack = -1e-5;
    return u < slack || v < slack || w < slack ? null : u * p[a + 2] + v * p[b + 2] + w * p[c + 2];
  }
}
