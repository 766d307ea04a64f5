// SPDX-License-Identifier: GPL-3.0-or-later
//
// The line that a file of somebody's device holds: GPX, GeoJSON, or CSV.
import type { MapPosition } from 'ptin-decoder';
import { Problem } from 'ptin-decoder/values';

export interface LineInFile {
  line: MapPosition[];
  /** Degrees of WGS 84; else map units of the terrain. */
  isLonLat: boolean;
}

/** Corners of a line of which heights are asked at once: of longer ones so many are kept, at equal counts apart. */
const mostCorners = 400;

/** Throws a Problem where the file holds no line. */
export function lineInFile(name: string, text: string): LineInFile {
  const extension = /\.(\w+)$/.exec(name)?.[1].toLowerCase() ?? '';
  const found = extension === 'gpx' || /<gpx[\s>]/.test(text.slice(0, 1000)) ? lineInGpx(text)
    : /json$/.test(extension) || text.trimStart().startsWith('{') ? lineInGeoJson(text) : lineInCsv(text);
  const line = found.line.filter((p, i, all) => i === 0 || p.x !== all[i - 1].x || p.y !== all[i - 1].y);
  if (line.length < 2 || !line.every((p) => Number.isFinite(p.x) && Number.isFinite(p.y))) throw noLine(name);
  const step = Math.max(1, (line.length - 1) / (mostCorners - 1));
  const count = Math.min(line.length, mostCorners);
  return { ...found, line: Array.from({ length: count }, (_, i) => line[Math.min(line.length - 1, Math.round(i * step))]) };
}

function noLine(name: string): Problem {
  return new Problem('No line', `${name} holds no line of two points. What becomes a profile: a track or route of GPX, a LineString of ` +
    'GeoJSON, or CSV with columns x and y, or lon and lat.');
}

/** The points of the first track, else of the first route, else the waypoints. */
function lineInGpx(text: string): LineInFile {
  const points = (tag: string): MapPosition[] => [...text.matchAll(new RegExp(`<${tag}\\s[^>]*>`, 'g'))].map(([head]) => {
    const of = (attribute: string): number => Number(new RegExp(`\\s${attribute}\\s*=\\s*["']([^"']+)["']`).exec(head)?.[1] ?? NaN);
    return { x: of('lon'), y: of('lat') };
  });
  const line = ['trkpt', 'rtept', 'wpt'].map(points).find((all) => all.length > 1) ?? [];
  return { line, isLonLat: true };
}

interface Geometry {
  type?: string;
  coordinates?: unknown;
  geometry?: Geometry | null;
  geometries?: Geometry[];
  features?: Geometry[];
}

/** The first line, part of lines, or ring. */
function lineInGeoJson(text: string): LineInFile {
  let json: Geometry;
  try {
    json = JSON.parse(text) as Geometry;
  } catch {
    throw new Problem('No GeoJSON', 'The file is no JSON.');
  }
  const lineOf = (g: Geometry | null | undefined): number[][] | null => {
    if (g === null || g === undefined) return null;
    if (g.type === 'LineString' || g.type === 'MultiPoint') return g.coordinates as number[][];
    if (g.type === 'MultiLineString' || g.type === 'Polygon') return (g.coordinates as number[][][])[0] ?? null;
    const parts = g.features ?? g.geometries ?? [g.geometry];
    for (const part of parts) {
      const found = lineOf(part);
      if (found !== null) return found;
    }
    return null;
  };
  return { line: (lineOf(json) ?? []).map(([x, y]) => ({ x, y })), isLonLat: true };
}

/** Columns by their names; without a head the first two. */
function lineInCsv(text: string): LineInFile {
  const rows = text.split(/\r?\n/).filter((row) => row.trim() !== '').map((row) => row.split(/[,;\t]/).map((cell) => cell.trim()));
  const head = rows[0]?.map((cell) => cell.toLowerCase().replace(/"/g, '')) ?? [];
  const column = (pattern: RegExp): number => head.findIndex((name) => pattern.test(name));
  const lon = column(/^(lon|lng|long|longitude)$/), lat = column(/^(lat|latitude)$/);
  const x = column(/^(x|e|east|easting)$/), y = column(/^(y|n|north|northing)$/);
  const isLonLat = lon >= 0 && lat >= 0;
  const [first, second] = isLonLat ? [lon, lat] : x >= 0 && y >= 0 ? [x, y] : [0, 1];
  const hasHead = head.some((name) => name !== '' && Number.isNaN(Number(name)));
  const cell = (row: string[], i: number): number => ((row[i] ?? '') === '' ? NaN : Number(row[i]));
  return { line: (hasHead ? rows.slice(1) : rows).map((row) => ({ x: cell(row, first), y: cell(row, second) })), isLonLat };
}
