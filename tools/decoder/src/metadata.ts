// SPDX-License-Identifier: GPL-3.0-or-later
//
// Facts that the sender of a stream tells beside its numbers.
import type { Window } from './map_window.js';
import type { GroundFacts } from './module.js';

/** The request of the stream: its certificate holds there. */
export interface StreamRequest {
  window?: Window;
  error?: number;
  levels?: number[];
  splits?: number;
}

/** Names of units, as `metre` or `US survey foot`; `unknown` where nobody told. */
export interface Units {
  horizontal: string;
  height: string;
}

/** A map of somebody else that may lie over a terrain. Nothing here asks for its tiles. */
export interface BaseMap {
  /** The address of a tile of Web Mercator, with {z}, {x} and {y} or {TileMatrix}, {TileCol} and {TileRow}. */
  tiles: string;
  /** The attribution; empty: nobody told. */
  attribution: string;
}

/** Facts that the metadata of a stream tell. */
export interface Told {
  /** The title of the terrain, and its attribution; empty: not told. */
  title: string;
  attribution: string;
  /** A map that may lie over the terrain; null: not told. */
  baseMap: BaseMap | null;
  /** The CRS of the map positions as WKT, and of the heights where that is known; null: not told. */
  crs: string | null;
  units: Units;
  /** Null: written by a program that did not tell it. */
  ground: GroundFacts | null;
  freeOfVoids: boolean;
  request: StreamRequest;
}

/**
 * The part of a CRS that is about the map: of a compound one the first part, else all of it.
 * @param wkt  Well-known text, as Told.crs
 */
export function mapCrsOf(wkt: string): string {
  if (!/^(COMPOUNDCRS|COMPD_CS)\[/.test(wkt)) return wkt;
  // A text in quotes (a quote in it is written twice), a bracket, or a comma between two parts.
  let depth = 0, begin = -1;
  for (const { 0: part, index } of wkt.matchAll(/"[^"]*"|[[\],]/g)) {
    if (part === '[') ++depth;
    else if (part === ']') --depth;
    if (part !== ',' || depth !== 1) continue;
    if (begin >= 0) return wkt.slice(begin, index).trim();
    begin = index + 1;
  }
  return wkt;
}

/** A text, or nothing. */
export function textOf(value: unknown): string {
  return typeof value === 'string' ? value : '';
}

/** A base map as services and streams tell it; null where it is none. */
export function baseMapOf(told: unknown): BaseMap | null {
  const { tiles, attribution } = (told ?? {}) as { tiles?: unknown; attribution?: unknown };
  const template = textOf(tiles);
  const hasPlaces = [/\{z\}|\{TileMatrix\}/, /\{x\}|\{TileCol\}/, /\{y\}|\{TileRow\}/].every((place) => place.test(template));
  if (!hasPlaces || !/^https?:\/\/[^/?{}]+[/?]/.test(template)) return null;
  try {
    return new URL(template).host === '' ? null : { tiles: template, attribution: textOf(attribution) };
  } catch {
    return null;
  }
}

/** The facts that metadata tell; text that is none tells nothing. */
export function toldBy(metadata: unknown): Told {
  const all = (metadata ?? {}) as {
    crs?: { wkt?: unknown } | null; units?: Partial<Units>; ground?: Partial<GroundFacts>; free_of_voids?: unknown;
    request?: StreamRequest; title?: unknown; attribution?: unknown; base_map?: unknown;
  };
  const g = all.ground;
  const isLength = (value: unknown): value is number => typeof value === 'number' && value > 0 && Number.isFinite(value);
  const known = g !== undefined && isLength(g.semi_major) && isLength(g.metres_per_height) &&
    isLength(g.geographic === true ? g.radians_per_map_unit : g.metres_per_map_unit);
  return {
    title: textOf(all.title), attribution: textOf(all.attribution), baseMap: baseMapOf(all.base_map),
    crs: typeof all.crs?.wkt === 'string' ? all.crs.wkt : null,
    units: { horizontal: all.units?.horizontal ?? 'unknown', height: all.units?.height ?? 'unknown' },
    ground: !known ? null : {
      geographic: g.geographic === true, semi_major: g.semi_major as number, inverse_flattening: Number(g.inverse_flattening) || 0,
      radians_per_map_unit: g.radians_per_map_unit ?? 0, metres_per_map_unit: g.metres_per_map_unit ?? 1,
      metres_per_height: g.metres_per_height as number,
    },
    freeOfVoids: all.free_of_voids === true,
    request: all.request ?? {},
  };
}
