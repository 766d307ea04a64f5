// SPDX-License-Identifier: GPL-3.0-or-later
//
// Camera and settings in the address, behind #: whoever opens it sees the same.
import type { MapPosition } from 'ptin-decoder';
import { rounded } from './format';
import type { Tool } from './inquiry';
import type { Shading } from './relief';
import type { Pose } from './view';

export interface Settings {
  shading: Shading;
  wireframe: boolean;
  /** How many times as high as it is the terrain is drawn; 0: as its own relief wants it (view). */
  exaggeration: number;
  /** The light's direction, degrees: clockwise from the top of the picture, above the horizon. */
  azimuth: number;
  altitude: number;
  /** Between isolines, in the height's unit; 0: none. */
  interval: number;
  /** At which refinement stops; 0: all there is. */
  error: number;
}

export const defaults: Settings = {
  shading: 'height', wireframe: false, exaggeration: 0, azimuth: 315, altitude: 42, interval: 0, error: 0,
};

/** A question: a tool, places of the map, and what its form said. */
export interface AskedLink {
  tool: Tool;
  places: MapPosition[];
  values: number[];
}

const tools: readonly Tool[] = ['height', 'profile', 'area', 'sight', 'viewshed'];
/** More corners make no address. */
const mostPlaces = 100;

/** A question as a part of the hash; empty for nothing, and for lines too long for an address. */
export function askedToHash(asked: AskedLink | null): string {
  if (asked === null || asked.places.length > mostPlaces) return '';
  const places = asked.places.map((p) => `${rounded(p.x, 12)},${rounded(p.y, 12)}`).join(';');
  return `&ask=${asked.tool}:${places}` + (asked.values.length === 0 ? '' : `&with=${asked.values.join(',')}`);
}

/** The question of a hash; null for none, or nothing that can be read. */
export function askedInHash(hash: string): AskedLink | null {
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  const [name, text = ''] = (parts.get('ask') ?? '').split(':');
  const tool = tools.find((t) => t === name);
  const places = text.split(';').map((pair) => pair.split(',').map(Number));
  if (tool === undefined || places.length > mostPlaces || places.some((p) => p.length !== 2 || !p.every(Number.isFinite))) return null;
  const values = (parts.get('with') ?? '').split(',').filter((v) => v !== '').map(Number);
  return { tool, places: places.map(([x, y]) => ({ x, y })), values: values.every((v) => v >= 0 && v < 1e12) ? values : [] };
}

export function toHash(pose: Pose | null, settings: Settings): string {
  const parts = new URLSearchParams();
  if (pose !== null) {
    parts.set('at', [
      rounded(pose.x, 10), rounded(pose.y, 10), rounded(pose.height, 5), rounded(pose.distance, 5), rounded(pose.heading, 4),
      rounded(pose.tilt, 4),
    ].join(','));
  }
  // A link shows no base map: its host is asked for nothing unless somebody here turns it on.
  if (settings.shading !== defaults.shading && settings.shading !== 'map') parts.set('shading', settings.shading);
  if (settings.wireframe) parts.set('wireframe', '1');
  for (const key of ['exaggeration', 'azimuth', 'altitude', 'interval', 'error'] as const) {
    if (settings[key] !== defaults[key]) parts.set(key, String(rounded(settings[key], 5)));
  }
  return parts.toString().replace(/%2C/g, ',');
}

/** Pose and settings of a hash; what it does not say, or says wrongly, is as it is at first. */
export function fromHash(hash: string): { pose: Pose | null; settings: Settings } {
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  const settings = { ...defaults };
  const shading = parts.get('shading');
  if (shading === 'height' || shading === 'slope' || shading === 'shade') settings.shading = shading;
  settings.wireframe = parts.get('wireframe') === '1';
  const ranges = { exaggeration: [0.5, 20], azimuth: [0, 360], altitude: [5, 90], interval: [0, 1e9], error: [0, 1e9] } as const;
  for (const [key, [low, high]] of Object.entries(ranges) as Array<[keyof typeof ranges, readonly [number, number]]>) {
    const value = Number(parts.get(key) ?? NaN);
    if (value >= low && value <= high) settings[key] = value;
  }
  const at = (parts.get('at') ?? '').split(',').map(Number);
  const isPose = at.length === 6 && at.every(Number.isFinite) && at[3] > 0;
  const [x, y, height, distance, heading, tilt] = at;
  return { pose: isPose ? { x, y, height, distance, heading, tilt } : null, settings };
}
