// SPDX-License-Identifier: GPL-3.0-or-later
//
// The endpoints of `ptin serve` that the viewer asks. Nothing else of it knows their addresses or answers.
import { count, number } from './format';
import type { Frame } from './frame';
import { Problem, checkAnswer, opened } from './fetching';
import type { Answer, MapPosition, Viewshed } from './messages';
import type { Located, PointState, Sight, SightRequest, Station } from './walk';

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
  async height(at: MapPosition, frame: Frame): Promise<Answer> {
    const { json, cost } = await this.asked('position', { coords: `POINT(${at.x} ${at.y})`, crs: 'native', f: 'json' });
    const point = (json.points as Array<Record<string, unknown>>)[0];
    const triangle = (point.triangle as Array<[number, number, number | null]> | null) ?? [];
    const located: Located = {
      state: point.state as PointState,
      height: point.height as number | null,
      triangle: triangle.map(([x, y, height]) => ({ x: frame.gridX(x), y: frame.gridY(y), height })),
    };
    return { kind: 'height', at, located, certificate: certificateOf(json), cost };
  }

  async profile(from: MapPosition, to: MapPosition, frame: Frame): Promise<Answer> {
    const { json } = await this.asked('profile', { coords: lineText(from, to), crs: 'native', f: 'json' });
    return {
      kind: 'profile', from, to, stations: stationsIn(json, frame), length: frame.metresBetween(from, to),
      certificate: certificateOf(json),
    };
  }

  async sight(from: MapPosition, to: MapPosition, request: SightRequest, frame: Frame): Promise<Answer> {
    const heights = [request.observerHeight, request.targetHeight].map((metres) => metres / frame.scaleZ).join(',');
    const query: Record<string, unknown> = { coords: lineText(from, to), heights, crs: 'native', f: 'json' };
    if (request.frequency > 0) query.frequency = request.frequency;
    const [{ json }, profile] = await Promise.all([this.asked('sight', query), this.profile(from, to, frame)]);
    if (profile.kind !== 'profile') throw new Error('a profile is asked for');
    const pair = (json.pairs as Array<Record<string, unknown>>)[0];
    return {
      kind: 'sight', from, to, request, stations: profile.stations, sight: sightIn(pair, profile.stations, request, frame),
      certificate: { error: profile.certificate.error, deviation: Number(pair.certified_deviation ?? 0) },
    };
  }

  async viewshed(at: MapPosition, height: number, radius: number, frame: Frame): Promise<Answer> {
    const response = await opened(this.address('viewshed', {
      coords: `POINT(${at.x} ${at.y})`, height: height / frame.scaleZ, radius: radius / frame.scaleZ, crs: 'native', f: 'png',
    }), {});
    await checkAnswer(response);
    const window = (response.headers.get('Ptin-Bounds') ?? '').split(',').map(Number);
    if (window.length !== 4 || window.some(Number.isNaN)) {
      throw new Problem('The viewshed has no place', 'The service did not say where its picture lies.');
    }
    const viewshed: Viewshed = { picture: await response.blob(), window: window as Viewshed['window'] };
    return { kind: 'viewshed', at, viewshed };
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

function certificateOf(json: Json): { error: number; deviation: number } {
  return { error: Number(json.certified_error ?? 0), deviation: Number(json.certified_deviation ?? 0) };
}

/** The points of a profile as stations in metres, with a null where the surface is broken. */
function stationsIn(json: Json, frame: Frame): Station[] {
  const stations: Station[] = [];
  for (const p of json.points as Array<{ x: number; y: number; distance: number; height: number | null; state: string }>) {
    const distance = p.distance * frame.scaleZ;
    if (p.height !== null) stations.push({ distance, height: p.height });
    if (p.state !== 'surface') stations.push({ distance, height: null });
  }
  while (stations.length !== 0 && stations[stations.length - 1].height === null) stations.pop();
  return stations;
}

function sightIn(pair: Json, stations: Station[], request: SightRequest, frame: Frame): Sight | null {
  const first = stations.find((s) => s.height !== null);
  const last = [...stations].reverse().find((s) => s.height !== null);
  if (first === undefined || last === undefined) return null;
  const metres = (value: unknown): number => Number(value) * frame.scaleZ;
  const length = metres(pair.length);
  const clearance = pair.clearance as { distance: number; min: number; max: number; height: number } | null;
  const fresnel = pair.fresnel as { distance: number; ratio: number } | undefined;
  const verdict = String(pair.verdict);
  return {
    verdict: verdict === 'visible' || verdict === 'hidden' ? verdict : 'unsure',
    clearance: clearance === null ? Infinity : metres((clearance.min + clearance.max) / 2),
    clearanceAt: clearance === null ? 0.5 : metres(clearance.distance) / length,
    fresnelRatio: fresnel === undefined ? null : fresnel.ratio,
    fresnelAt: fresnel === undefined ? 0.5 : metres(fresnel.distance) / length,
    length,
    observerZ: (first.height as number) * frame.scaleZ + request.observerHeight,
    targetZ: (last.height as number) * frame.scaleZ + request.targetHeight,
  };
}
