// SPDX-License-Identifier: GPL-3.0-or-later
//
// The certificate of all that is in sight: certificates of streams hold in the windows that were asked for.
import type { Decoder } from './decoder.js';
import { type Certificate, boundsOf } from './facts.js';
import { type StreamRequest, toldBy } from './metadata.js';
import { type MapPosition, type Window, holds, windowAround } from './map_window.js';

/** A certificate that holds within a window of the map. */
export interface CertifiedPart extends Certificate {
  window: Window;
}

/** Certificates of a mesh: a place has the least of the parts that hold it. Where there is none nothing is known of the mesh. */
export type Certified = readonly CertifiedPart[];

/**
 * The certificates of a single stream: what it certifies holds where it was asked for. One for isolines is certified along these
 * alone, so of no window.
 */
export function certifiedOf(decoder: Decoder, request: StreamRequest = toldBy(decoder.metadata).request): Certified {
  const { certificate } = decoder;
  if (certificate === null || request.levels !== undefined) return [];
  return [{ window: request.window ?? boundsOf(decoder.facts), ...certificate }];
}

function cuts(parts: readonly CertifiedPart[], bounds: Window, axis: 0 | 1): number[] {
  const low = bounds[axis], high = bounds[axis + 2];
  // A thinner cell is the rounding of one edge that two windows have.
  const least = 1e-9 * (high - low);
  const made = [low];
  for (const v of parts.flatMap((p) => [p.window[axis], p.window[axis + 2]]).sort((a, b) => a - b)) {
    if (v > made[made.length - 1] + least && v < high - least) made.push(v);
  }
  return [...made, high];
}

/**
 * The certificate that holds in every part of `bounds` that `isSeen`, which may take what is not seen for seen but never the
 * other way round; null when nothing is known of one. Where nothing is seen it is that of all of `bounds`. Cost: the square of the
 * number of parts, and with each as many as there are parts.
 */
export function certifiedWithin(
  certified: Certified, bounds: Window, isSeen: (window: Window) => boolean = () => true,
): Certificate | null {
  const parts = certified.filter((p, i, all) => !all.some((q, k) =>
    k !== i && holds(q.window, p.window) && q.error <= p.error && q.deviation <= p.deviation && (k < i || !holds(p.window, q.window))));
  const xs = cuts(parts, bounds, 0), ys = cuts(parts, bounds, 1);
  const seen = { error: -1, deviation: -1 }, all = { error: -1, deviation: -1 };
  for (let i = 1; i < xs.length; ++i) {
    for (let k = 1; k < ys.length; ++k) {
      const cell: Window = [xs[i - 1], ys[k - 1], xs[i], ys[k]];
      // The edges of a cell may be those of the next window, by their rounding: its middle is in one alone.
      const here = certifiedAt(parts, [{ x: (cell[0] + cell[2]) / 2, y: (cell[1] + cell[3]) / 2 }]) ?? unknown;
      worsen(all, here);
      const isWorse = here.error > seen.error || here.deviation > seen.deviation;
      if (isWorse && isSeen(cell)) worsen(seen, here);
    }
  }
  const worst = seen.error >= 0 ? seen : all;
  return worst.error < 0 || worst.error === unknown.error ? null : worst;
}

/** Worse than every certificate. */
const unknown: Certificate = { error: Infinity, deviation: Infinity };

function worsen(most: Certificate, by: Certificate): void {
  most.error = Math.max(most.error, by.error);
  most.deviation = Math.max(most.deviation, by.deviation);
}

/** The certificate at both ends of a line, and so all along it: windows are convex. Null where nothing is known of the mesh. */
export function certifiedAt(certified: Certified, places: readonly MapPosition[]): Certificate | null {
  const around = windowAround(places);
  const parts = certified.filter((part) => holds(part.window, around));
  if (parts.length === 0) return null;
  return { error: Math.min(...parts.map((p) => p.error)), deviation: Math.min(...parts.map((p) => p.deviation)) };
}
