// SPDX-License-Identifier: GPL-3.0-or-later
//
// Places and windows of the map: in the CRS of the terrain, whatever its unit; x is to the east, y to the north.

export interface MapPosition {
  x: number;
  y: number;
}

/** Closed. */
export type Window = readonly [west: number, south: number, east: number, north: number];

/** True when all of `inner` lies in `outer`. */
export function holds(outer: Window, inner: Window): boolean {
  return outer[0] <= inner[0] && outer[1] <= inner[1] && outer[2] >= inner[2] && outer[3] >= inner[3];
}

/** The least window around places. */
export function windowAround(places: readonly MapPosition[]): Window {
  const xs = places.map((p) => p.x), ys = places.map((p) => p.y);
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/** A window larger by a share of its size on each side, within `bounds`. */
export function widened(window: Window, bounds: Window, share: number): Window {
  const x = share * (window[2] - window[0]), y = share * (window[3] - window[1]);
  return [
    Math.max(bounds[0], window[0] - x), Math.max(bounds[1], window[1] - y),
    Math.min(bounds[2], window[2] + x), Math.min(bounds[3], window[3] + y),
  ];
}
