// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where things are: on the grid (whole numbers, exact), on the map (the file's CRS), and in the scene: metres around the
// middle of the terrain, so that 32 bits of a GPU are enough anywhere on Earth.
import type { Facts } from './decoder';

const metresPerUnit: Record<string, number> = {
  metre: 1, meter: 1, m: 1, kilometre: 1000, centimetre: 0.01, decimetre: 0.1, foot: 0.3048, ft: 0.3048,
  'US survey foot': 1200 / 3937, us_survey_foot: 1200 / 3937, 'international foot': 0.3048,
};
const metresPerDegree = (Math.PI / 180) * 6371008.8;

export interface Units {
  horizontal: string;
  height: string;
}

/** Units as the metadata of a stream tell them; unknown ones are taken for metres, and named so. */
export function unitsOf(metadata: unknown): Units {
  const units = (metadata as { units?: Partial<Units> } | null)?.units;
  return { horizontal: units?.horizontal ?? 'unknown', height: units?.height ?? 'unknown' };
}

/** The short sign of a unit, for labels. */
export function signOf(unit: string): string {
  if (unit === 'metre' || unit === 'unknown') return 'm';
  if (/foot|feet/.test(unit)) return 'ft';
  if (unit === 'degree') return '°';
  return unit;
}

export class Frame {
  /** The middle of the terrain, on the map. */
  readonly middleX: number;
  readonly middleY: number;
  /** Metres in the scene for a unit of the map, and of a height. */
  readonly scaleX: number;
  readonly scaleY: number;
  readonly scaleZ: number;
  /** The height that lies at z = 0. */
  readonly baseHeight: number;
  readonly isDegrees: boolean;

  constructor(readonly facts: Facts, readonly units: Units) {
    const f = facts;
    this.middleX = f.originX + f.stepX * (f.minX + f.maxX) / 2;
    this.middleY = f.originY + f.stepY * (f.minY + f.maxY) / 2;
    this.isDegrees = units.horizontal === 'degree';
    const metres = metresPerUnit[units.horizontal] ?? 1;
    this.scaleY = this.isDegrees ? metresPerDegree : metres;
    // One scale for the whole terrain: that of its middle parallel.
    this.scaleX = this.isDegrees ? metresPerDegree * Math.max(0.01, Math.cos(this.middleY * Math.PI / 180)) : metres;
    this.scaleZ = metresPerUnit[units.height] ?? 1;
    this.baseHeight = f.minHeight <= f.maxHeight ? f.minHeight : 0;
  }

  /** Extents of the terrain in the scene. */
  get width(): number { return (this.facts.maxX - this.facts.minX) * this.facts.stepX * this.scaleX; }
  get depth(): number { return (this.facts.maxY - this.facts.minY) * this.facts.stepY * this.scaleY; }
  get relief(): number { return Math.max(0, this.facts.maxHeight - this.facts.minHeight) * this.scaleZ; }

  sceneX(mapX: number): number { return (mapX - this.middleX) * this.scaleX; }
  sceneY(mapY: number): number { return (mapY - this.middleY) * this.scaleY; }
  sceneZ(height: number): number { return (height - this.baseHeight) * this.scaleZ; }
  mapX(sceneX: number): number { return this.middleX + sceneX / this.scaleX; }
  mapY(sceneY: number): number { return this.middleY + sceneY / this.scaleY; }
  heightAt(sceneZ: number): number { return this.baseHeight + sceneZ / this.scaleZ; }
  gridX(mapX: number): number { return (mapX - this.facts.originX) / this.facts.stepX; }
  gridY(mapY: number): number { return (mapY - this.facts.originY) / this.facts.stepY; }
  mapOfGridX(x: number): number { return this.facts.originX + this.facts.stepX * x; }
  mapOfGridY(y: number): number { return this.facts.originY + this.facts.stepY * y; }

  /** Metres over ground between two places of the map. */
  metresBetween(a: { x: number; y: number }, b: { x: number; y: number }): number {
    return Math.hypot((b.x - a.x) * this.scaleX, (b.y - a.y) * this.scaleY);
  }
}

const bits = new DataView(new ArrayBuffer(4));
/** The height of the bits that a vertex holds. */
export function heightOf(facts: Facts, heightBits: number): number {
  if (!facts.heightIsFloat) return facts.heightOffset + facts.heightStep * heightBits;
  bits.setInt32(0, heightBits);
  return facts.heightOffset + facts.heightStep * bits.getFloat32(0);
}
