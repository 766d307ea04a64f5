// SPDX-License-Identifier: GPL-3.0-or-later
//
// Answers of the engine, as its WebAssembly and the service give them. Nothing here is computed by the page.
import type { MapPosition } from 'ptin-decoder';

export type PointState = 'surface' | 'void' | 'outside';

/** A corner of a triangle, on the map. */
export interface Corner extends MapPosition {
  /** A height in its unit; null where the vertex has none. */
  height: number | null;
}

export interface Located {
  state: PointState;
  /** Null unless the state is surface; the full terrain's lies from `least` to `most`. */
  height: number | null;
  least: number | null;
  most: number | null;
  /** Empty outside. */
  triangle: Corner[];
}

/** The unit of distances along a profile. */
export interface Lengths {
  unit: string;
  /** Null: nobody knows. */
  metres: number | null;
}

/** A point of a profile; between two the surface is straight. Null: a gap begins. */
export interface Station extends MapPosition {
  distance: number;
  height: number | null;
}

export interface Profile {
  stations: Station[];
  length: number;
  lengths: Lengths;
}

export interface SightRequest {
  /** Above ground, in metres. */
  observerHeight: number;
  targetHeight: number;
  /** In hertz; 0: no Fresnel zone. */
  frequency: number;
}

/** A point of a line of sight; distance and height in the height's unit. */
export interface SightPoint extends MapPosition {
  distance: number;
  height: number;
}

/** A line of sight between two ends, in the height's unit. */
export interface Sight {
  /** `unsure`: what is left out could turn the answer; `undefined`: an end has no ground. */
  verdict: 'visible' | 'hidden' | 'unsure' | 'undefined';
  length: number;
  /** The height of the line above the ground, where it is least: from and to; null where there is no ground below it. */
  clearance: { min: number; max: number; at: SightPoint } | null;
  /** Least clearance in radii of the first Fresnel zone; null without a frequency, or where it is not known. */
  fresnel: { ratio: number; at: SightPoint } | null;
}
