// SPDX-License-Identifier: GPL-3.0-or-later
//
// The endpoints of `ptin serve` that the viewer asks. Nothing else of it knows their addresses or answers.
import { count, number } from './format';
import type { Frame } from './frame';
import { Problem, checkAnswer, opened } from './fetching';
import { stationsOf } from './answers';
import type { MapPosition, PointState, Profile, Sight, SightPoint, SightRequest } from './answers';
import type { Answer, Certainty, Viewshed } from './messages';

/** What a receiver was served, as `ptin unstream` tells it and `ptin stream --have` takes it. */
export interface Serving {
  window?: number[];
  error?: number;
  levels?: number[];
  splits?: number;
}

export interface Collection {
  title: string;
  bounds: [number, number, number, number];
  heights: [number, number];
  vertices: number;
  fingerprint: string;
}

export interface StreamAnswer {
  response: Response;
  /** Of the file that answered: streams of another one cannot go on from this one's. */
  fingerprint: string;
  /** What the answer cost the service, for people. */
  cost: string;
}

/** What an answer says that it cost: pages read, and time. */
export function costOf(response: Response): string {
  const timing = response.headers.get('Server-Timing') ?? '';
  const pages = /\bpages=(\d+)/.exec(timing), milliseconds = /\bdur=([\d.]+)/.exec(timing);
  const words = [];
  if (pages !== null) words.push(`${count(Number(pages[1]))} ${pages[1] === '1' ? 'page' : 'pages'}`);
  if (milliseconds !== null) words.push(`${number(Number(milliseconds[1]), 2)} ms`);
  return words.join(', ');
}

export class Service {
  private readonly base: string;

  constructor(service: string, readonly id: string) {
    this.base = `${service.replace(/\/$/, '')}/collections/${encodeURIComponent(id)}`;
  }

  async collection(): Promise<Collection> {
    const json = await this.json(this.base, {});
    const terrain = json.terrain as Partial<Collection> | undefined;
    if (terrain?.bounds === undefined || terrain.heights === undefined) {
      throw new Problem('This is no terrain service', `What answered at ${this.base} does not describe a terrain.`);
    }
    return {
      title: String(json.title ?? this.id), bounds: terrain.bounds, heights: terrain.heights,
      vertices: terrain.vertices ?? 0, fingerprint: terrain.fingerprint ?? '',
    };
  }

  /** Asks for what `have` lacks of a window at an error. Errors of 409 and 413 say that one has to begin anew. */
  async stream(
    window: readonly number[] | null, error: number, mostBytes: number, have: Serving[], fingerprint: string,
    signal: AbortSignal,
  ): Promise<StreamAnswer> {
    const asked: Record<string, unknown> = { error, max_bytes: mostBytes };
    if (window !== null) asked.window = window;
    if (have.length !== 0) asked.have = have;
    if (have.length !== 0 && fingerprint !== '') asked.fingerprint = fingerprint;
    const response = await opened(`${this.base}/stream`, {
      method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(asked), signal,
    });
    return { response, fingerprint: response.headers.get('Ptin-Fingerprint') ?? fingerprint, cost: costOf(response) };
  }

  /** The height of the full terrain, whatever is drawn. */
  async height(at: MapPosition): Promise<Answer> {
    const { json, cost } = await this.asked('position', { coords: `POINT(${at.x} ${at.y})`, crs: 'native', f: 'json' });
    const point = (json.points as Array<Record<string, unknown>>)[0];
    const triangle = (point.triangle as Array<[number, number, number | null]> | null) ?? [];
    return {
      kind: 'height', at, certainty: certaintyOf(json), cost,
      located: {
        state: point.state as PointState, height: point.height as number | null, least: point.height_min as number | null,
        most: point.height_max as number | null, triangle: triangle.map(([x, y, height]) => ({ x, y, height })),
      },
    };
  }

  async profile(from: MapPosition, to: MapPosition, frame: Frame): Promise<Answer> {
    const { json } = await this.asked('profile', { coords: lineText(from, to), crs: 'native', f: 'json' });
    return { kind: 'profile', from, to, profile: profileIn(json, frame), certainty: certaintyOf(json) };
  }

  async sight(from: MapPosition, to: MapPosition, request: SightRequest, frame: Frame): Promise<Answer> {
    const heights = [request.observerHeight, request.targetHeight].map((metres) => metres / frame.scaleZ).join(',');
    const query: Record<string, unknown> = { coords: lineText(from, to), heights, crs: 'native', f: 'json' };
    if (request.frequency > 0) query.frequency = request.frequency;
    const [{ json }, along] = await Promise.all([
      this.asked('sight', query), this.asked('profile', { coords: lineText(from, to), crs: 'native', f: 'json' }),
    ]);
    return {
      kind: 'sight', from, to, request, profile: profileIn(along.json, frame),
      sight: sightIn((json.pairs as Json[])[0]), certainty: certaintyOf(json),
    };
  }

  async viewshed(at: MapPosition, observerHeight: number, targetHeight: number, radius: number, frame: Frame): Promise<Answer> {
    const response = await opened(this.address('viewshed', {
      coords: `POINT(${at.x} ${at.y})`, height: observerHeight / frame.scaleZ, target: targetHeight / frame.scaleZ,
      radius: radius / frame.scaleZ, crs: 'native', f: 'png',
    }), {});
    await checkAnswer(response);
    const window = (response.headers.get('Ptin-Bounds') ?? '').split(',').map(Number);
    if (window.length !== 4 || window.some(Number.isNaN)) {
      throw new Problem('The viewshed has no place', 'The service did not say where its picture lies.');
    }
    const viewshed: Viewshed = { picture: await response.blob(), window: window as Viewshed['window'] };
    return { kind: 'viewshed', at, radius, viewshed };
  }

  private address(question: string, query: Record<string, unknown>): string {
    const text = new URLSearchParams(Object.entries(query).map(([k, v]): [string, string] => [k, String(v)]));
    return `${this.base}/${question}?${text}`;
  }

  private async asked(question: string, query: Record<string, unknown>): Promise<{ json: Json; cost: string }> {
    const response = await opened(this.address(question, query), {});
    await checkAnswer(response);
    return { json: await response.json() as Json, cost: costOf(response) };
  }

  private async json(address: string, init: RequestInit): Promise<Json> {
    const response = await opened(address, { headers: { Accept: 'application/json' }, ...init });
    await checkAnswer(response);
    try {
      return await response.json() as Json;
    } catch {
      throw new Problem('This is no terrain service', `What answered at ${address} is not JSON.`);
    }
  }
}

type Json = Record<string, unknown>;

function lineText(from: MapPosition, to: MapPosition): string {
  return `LINESTRING(${from.x} ${from.y}, ${to.x} ${to.y})`;
}

function certaintyOf(json: Json): Certainty {
  return {
    of: 'terrain', error: Number(json.certified_error ?? 0), deviation: Number(json.certified_deviation ?? 0),
    isExact: json.exact === true,
  };
}

/** Points and distances as the service has them, in the unit that it names. */
function profileIn(json: Json, frame: Frame): Profile {
  const points = json.points as Array<MapPosition & { distance: number; height: number | null; state: PointState }>;
  const unit = String(json.length_unit ?? 'unknown');
  return {
    stations: stationsOf(points), length: points[points.length - 1]?.distance ?? 0,
    lengths: { unit, metres: unit === 'metre' ? 1 : unit === frame.earth.lengths.unit ? frame.earth.lengths.metres : null },
  };
}

function sightIn(pair: Json): Sight {
  const clearance = pair.clearance as (SightPoint & { min: number; max: number | null }) | null;
  const fresnel = pair.fresnel as (SightPoint & { ratio: number }) | undefined;
  const verdicts: Record<string, Sight['verdict']> = { visible: 'visible', hidden: 'hidden', null: 'undefined' };
  return {
    verdict: verdicts[String(pair.verdict)] ?? 'unsure', length: Number(pair.length),
    clearance: clearance === null ? null : { min: clearance.min, max: clearance.max ?? Infinity, at: clearance },
    fresnel: fresnel === undefined ? null : { ratio: fresnel.ratio, at: fresnel },
  };
}
