// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Earth below the terrain, as the engine tells it from what a stream says of its CRS.
import type { Decoder, MapPosition, Told } from 'ptin-decoder';
import { onMap } from 'ptin-decoder/values';
import type { Lengths } from './answers';

export interface Earth {
  isDegrees: boolean;
  lengths: Lengths;
  metresPerHeight: number;
  /** Numbers that lines of sight are drawn with (Decoder). */
  curvature: number;
  lightSpeed: number;
  /** Metres of a map unit along x and along y, at parallels from south to north. */
  scales: Array<{ y: number; x: number; perY: number }>;
  /** Lengths of the terrain along its middle parallel and its middle meridian, metres; null: not known. */
  size: [number, number] | null;
}

/** Rough, for pictures of streams that do not tell their ellipsoid: no number is made of it. */
const roughDegree = 111195;
const parallels = 64;

/** The Earth below what `decoder` holds, to which `told` was described. */
export function earthOf(decoder: Decoder, { ground, units }: Told): Earth {
  const { facts } = decoder;
  const isDegrees = ground?.geographic ?? units.horizontal === 'degree';
  const at = (x: number, y: number): MapPosition =>
    onMap(facts, facts.minX + x * (facts.maxX - facts.minX), facts.minY + y * (facts.maxY - facts.minY));
  const isUnknown = ground === null || (!isDegrees && units.horizontal === 'unknown');
  const scale = (place: MapPosition): [number, number] => {
    if (ground !== null) return decoder.metresPerMapUnit(place);
    return isDegrees ? [roughDegree * Math.max(0.01, Math.cos(place.y * Math.PI / 180)), roughDegree] : [1, 1];
  };
  const between = (a: MapPosition, b: MapPosition): number => (isUnknown ? NaN : decoder.metresBetween(a, b));
  const size: [number, number] = [between(at(0, 0.5), at(1, 0.5)), between(at(0.5, 0), at(0.5, 1))];
  return {
    isDegrees,
    lengths: isDegrees ? { unit: 'metre', metres: 1 } : { unit: units.horizontal, metres: isUnknown ? null : ground.metres_per_map_unit },
    metresPerHeight: ground?.metres_per_height ?? 1,
    curvature: decoder.curvature,
    lightSpeed: decoder.lightSpeed,
    scales: Array.from({ length: parallels + 1 }, (_, i) => {
      const place = at(0.5, i / parallels);
      const [x, perY] = scale(place);
      return { y: place.y, x, perY };
    }),
    size: size.every(Number.isFinite) ? size : null,
  };
}

/** Metres of a map unit along x and along y at a parallel of the terrain. */
export function scaleAt(earth: Earth, y: number): [number, number] {
  const { scales } = earth;
  const last = scales.length - 1;
  const span = scales[last].y - scales[0].y;
  const place = span > 0 ? Math.max(0, Math.min(last, last * (y - scales[0].y) / span)) : 0;
  const a = scales[Math.floor(place)], b = scales[Math.min(last, Math.floor(place) + 1)];
  const part = place - Math.floor(place);
  return [a.x + part * (b.x - a.x), a.perY + part * (b.perY - a.perY)];
}
