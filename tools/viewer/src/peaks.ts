// SPDX-License-Identifier: GPL-3.0-or-later
//
// Peaks of a terrain of a service: the highest vertex of each square of a grid, where it is a summit and not the side of something
// higher beside. Squares are asked for once, one after the other, when the camera rests.
import type { MapPosition, Window } from 'ptin-decoder';

export type Highest = (window: Window) => Promise<(MapPosition & { height: number }) | null>;

/** Squares across what is seen. */
const across = 4;

/** The squares of the terrain's halvings that a window meets, some `across` of them along its longer side, by their names. */
export function squaresIn(window: Window, bounds: Window): Map<string, Window> {
  const width = bounds[2] - bounds[0], height = bounds[3] - bounds[1];
  const found = new Map<string, Window>();
  const span = Math.max((window[2] - window[0]) / width, (window[3] - window[1]) / height);
  if (!(span > 0) || !(width > 0) || !(height > 0)) return found;
  const parts = 2 ** Math.max(0, Math.min(20, Math.round(Math.log2(across / Math.min(1, span)))));
  const first = (value: number, low: number, size: number): number => Math.max(0, Math.floor((value - low) / size * parts));
  const last = (value: number, low: number, size: number): number => Math.min(parts - 1, Math.ceil((value - low) / size * parts) - 1);
  for (let i = first(window[0], bounds[0], width); i <= last(window[2], bounds[0], width); ++i) {
    for (let k = first(window[1], bounds[1], height); k <= last(window[3], bounds[1], height); ++k) {
      found.set(`${parts} ${i} ${k}`, [
        bounds[0] + width * i / parts, bounds[1] + height * k / parts,
        bounds[0] + width * (i + 1) / parts, bounds[1] + height * (k + 1) / parts,
      ]);
    }
  }
  return found;
}

export class Peaks {
  private readonly known = new Map<string, (MapPosition & { height: number }) | null>();
  private round = 0;

  /** @param highest  Asks the service; a refusal leaves the square without a peak. */
  constructor(private readonly highest: Highest) {}

  /** The peaks of the squares that windows meet; stops where it is asked for others meanwhile. */
  async within(windows: readonly Window[], bounds: Window): Promise<Array<MapPosition & { height: number }>> {
    const round = ++this.round;
    const squares = new Map(windows.flatMap((window) => [...squaresIn(window, bounds)]));
    for (const [name, square] of squares) {
      if (this.known.has(name)) continue;
      const found = await this.highest(square).catch(() => null);
      this.known.set(name, found);
      if (round !== this.round) return [];
    }
    const peaks = [...squares.keys()].flatMap((name) => this.known.get(name) ?? []);
    // A peak of a large square is that of a smaller one in it, too.
    return [...new Map(peaks.map((peak) => [`${peak.x} ${peak.y}`, peak])).values()];
  }
}
