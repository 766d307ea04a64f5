// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain of `ptin serve` by its address, http://host/collections/ID: what it is, and streams of what a receiver lacks.
import type { Window } from './map_window.js';
import { type BaseMap, baseMapOf, textOf } from './metadata.js';
import type { Serving } from './received.js';
import { Problem, opened } from './requests.js';

/** A terrain as its service tells it. */
export interface Collection {
  title: string;
  /** The attribution; empty: nobody told. */
  attribution?: string;
  bounds: Window;
  /** The most that the service gives a question, by the names of its limits; those that it tells. */
  limits?: Readonly<Record<string, number>>;
  /** The least and the greatest of the samples. */
  heights: readonly [number, number];
  /** Degrees of a projected CRS; null where its service does not tell. */
  lonLat?: LonLatNodes | null;
  /** A map of somebody else that pages may lay over the terrain; null: neither its service nor its file names one. */
  baseMap?: BaseMap | null;
}

/**
 * Longitudes and latitudes at the thirds of `bounds`, from the least x and y, row by row along x; between them the polynomial through
 * the four of each row, then through the four rows, is off by some `within` degrees: twice the most that the service found at 49
 * places, a measurement and no bound. Longitudes may be beyond 180.
 */
export interface LonLatNodes {
  nodes: ReadonlyArray<readonly [lon: number, lat: number]>;
  within: number;
}

/** The body of POST .../stream. */
export interface StreamBody {
  window: Window;
  error?: number;
  max_bytes: number;
  have?: readonly Serving[];
  fingerprint?: string;
}

export async function collectionAt(address: string, signal?: AbortSignal): Promise<Collection> {
  const response = await opened(address, { signal: signal ?? null, headers: { Accept: 'application/json' } });
  const json = await response.json().catch(() => {
    signal?.throwIfAborted();
    throw new Problem('This is no terrain service', `What answered at ${address} is not JSON.`, response.status);
  }) as { title?: unknown; attribution?: unknown; base_map?: unknown; limits?: Record<string, number>; terrain?: Partial<Collection> & { lon_lat?: LonLatNodes | null } } | null;
  const terrain = json?.terrain;
  if (terrain?.bounds === undefined || terrain.heights === undefined) {
    throw new Problem('This is no terrain service', `What answered at ${address} does not describe a terrain.`, response.status);
  }
  return {
    title: String(json?.title ?? address.split('/').pop()), attribution: textOf(json?.attribution), bounds: terrain.bounds,
    heights: terrain.heights, limits: json?.limits ?? {}, lonLat: terrain.lon_lat ?? null,
    baseMap: baseMapOf(json?.base_map),
  };
}

/** Asks for what lacks. Problems of 409 and 413 say that one has to begin anew, or to ask for less. */
export function streamOf(address: string, asked: StreamBody, signal?: AbortSignal): Promise<Response> {
  return opened(`${address}/stream`, {
    method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(asked), signal: signal ?? null,
  });
}
