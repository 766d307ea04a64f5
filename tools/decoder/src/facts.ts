// SPDX-License-Identifier: GPL-3.0-or-later
//
// Facts of a terrain, and what its positions and heights are by them.
import type { MapPosition, Window } from './map_window.js';

/** In the order of the module's facts (wasm/decoder.cc). */
export const factNames = [
  'originX', 'originY', 'stepX', 'stepY', 'heightIsFloat', 'heightStep', 'heightOffset', 'minX', 'minY', 'maxX', 'maxY',
  'minHeight', 'maxHeight', 'baseError', 'baseDeviation',
] as const;
/**
 * Facts of the terrain. Positions in the mesh are on a grid: map = origin + step * grid. Least and greatest are of all samples of
 * the whole terrain; the least height is above the greatest when all is void. Before the first mesh none of them means anything.
 */
export type Facts = Readonly<Record<typeof factNames[number], number>>;

/** How far the mesh may be from the full terrain, in the unit of heights. Null stands for it where nothing is known. */
export interface Certificate {
  /** At every sample. */
  error: number;
  /** At any point. */
  deviation: number;
}

/** The map position of a place on the grid. */
export function onMap(facts: Facts, x: number, y: number): MapPosition {
  return { x: facts.originX + facts.stepX * x, y: facts.originY + facts.stepY * y };
}

const bits = new DataView(new ArrayBuffer(4));
/** The height of the bits that a vertex holds. */
export function heightOf(facts: Facts, heightBits: number): number {
  if (facts.heightIsFloat === 0) return facts.heightOffset + facts.heightStep * heightBits;
  bits.setInt32(0, heightBits);
  return facts.heightOffset + facts.heightStep * bits.getFloat32(0);
}

/** The whole terrain on the map. */
export function boundsOf(facts: Facts): Window {
  const southWest = onMap(facts, facts.minX, facts.minY), northEast = onMap(facts, facts.maxX, facts.maxY);
  return [southWest.x, southWest.y, northEast.x, northEast.y];
}
