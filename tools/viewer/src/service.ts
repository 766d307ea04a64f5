// SPDX-License-Identifier: GPL-3.0-or-later
//
// The endpoints of `ptin serve` that the viewer asks. Nothing else of it knows their addresses or answers.
import type { Collection, MapPosition, StreamBody, Window } from 'ptin-decoder';
import { collectionAt, opened, Problem, streamOf } from 'ptin-decoder/values';
import { count, number } from './format';
import type { Frame } from './frame';
import type { PointState, Profile, Sight, SightPoint } from './answers';
import type { Answer, Certainty, Question, QuestionOf, Volume } from './messages';
import { cornersOf, stationsOf } from './stations';

/** Milliseconds that an answer says it took; null: it does not say. */
export function millisecondsOf(response: Response): number | null {
  const took = /\bdur=([\d.]+)/.exec(response.headers.get('Server-Timing') ?? '');
  return took === null ? null : Number(took[1]);
}

/** The cost that an answer tells: pages read, and time. */
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

  collection(): Promise<Collection> { return collectionAt(this.base); }

  /** Asks for what lacks. Errors of 409 and 413 say that one has to begin anew. */
  stream(asked: StreamBody): Promise<Response> { return streamOf(this.base, asked); }

  /** An answer of the full terrain, whatever is drawn. */
  answer(question: Question, frame: Frame): Promise<Answer> {
    switch (question.kind) {
      case 'height': return this.height(question);
      case 'profile': return this.profile(question, frame);
      case 'sight': return this.sight(question, frame);
      case 'area': return this.area(question);
      case 'viewshed': return this.viewshed(question, frame);
    }
  }

  private async height(question: QuestionOf<'height'>): Promise<Answer> {
    const { json, cost } = await this.asked('position', { coords: pointText(question.at) });
    const point = (json.points as Array<Record<string, unknown>>)[0];
    const triangle = (point.triangle as Array<[number, number, number | null]> | null) ?? [];
    return {
      ...question, certainty: certaintyOf(json), cost,
      located: {
        state: point.state as PointState, height: point.height as number | null, least: point.height_min as number | null,
        most: point.height_max as number | null, triangle: triangle.map(([x, y, height]) => ({ x, y, height })),
      },
    };
  }

  private async profile(question: QuestionOf<'profile'>, frame: Frame): Promise<Answer> {
    const crs = question.isLonLat === true && !frame.isDegrees ? { crs: 'http://www.opengis.net/def/crs/OGC/1.3/CRS84' } : {};
    const { json } = await this.asked('profile', { coords: lineText(question), ...crs });
    return { ...question, profile: profileIn(json, frame), certainty: certaintyOf(json) };
  }

  private async sight(question: QuestionOf<'sight'>, frame: Frame): Promise<Answer> {
    const { observerHeight, targetHeight, frequency } = question.request;
    const coords = lineText(question), heights = [observerHeight / frame.scaleZ, targetHeight / frame.scaleZ];
    const [{ json }, along] = await Promise.all([
      this.asked('sight', { coords, heights, ...(frequency > 0 ? { frequency } : {}) }), this.asked('profile', { coords }),
    ]);
    return {
      ...question, profile: profileIn(along.json, frame), sight: sightIn((json.pairs as Json[])[0]), certainty: certaintyOf(json),
    };
  }

  private async area(question: QuestionOf<'area'>): Promise<Answer> {
    const ring = [...question.ring, question.ring[0]].map((p) => `${p.x} ${p.y}`).join(', ');
    const { json } = await this.asked('volume', { against: question.against, coords: `POLYGON((${ring}))` });
    const area = json.area as { surface: number; void: number };
    const units = json.units as { ground: string };
    return {
      ...question, certainty: certaintyOf(json),
      measured: {
        surface: area.surface, empty: area.void, cut: json.cut as Volume, fill: json.fill as Volume, unit: units.ground,
      },
    };
  }

  /** The highest vertex of a window, where it is one: a point on the window's border is the side of something higher. */
  async highest(window: Window): Promise<(MapPosition & { height: number }) | null> {
    const response = await this.answered('highest', 'geojson', { bbox: window.join(','), listed: 1 });
    interface Feature { geometry: { coordinates: [number, number] }; properties: { at_vertex: boolean; height: number } }
    const [found] = (await response.json() as { features: Feature[] }).features;
    if (found === undefined || !found.properties.at_vertex) return null;
    const [x, y] = found.geometry.coordinates;
    const edge = 1e-9 * Math.max(window[2] - window[0], window[3] - window[1]);
    const isWithin = x > window[0] + edge && x < window[2] - edge && y > window[1] + edge && y < window[3] - edge;
    return isWithin ? { x, y, height: found.properties.height } : null;
  }

  private async viewshed(question: QuestionOf<'viewshed'>, frame: Frame): Promise<Answer> {
    const { at, observerHeight, targetHeight, radius } = question;
    const response = await this.answered('viewshed', 'png', {
      coords: pointText(at), height: observerHeight / frame.scaleZ, target: targetHeight / frame.scaleZ, radius: radius / frame.scaleZ,
    });
    const window = (response.headers.get('Ptin-Bounds') ?? '').split(',').map(Number);
    if (window.length !== 4 || window.some(Number.isNaN)) {
      throw new Problem('The viewshed has no place', 'The service did not say where its picture lies.');
    }
    return { ...question, viewshed: { picture: await response.blob(), window: window as unknown as Window } };
  }

  private answered(question: string, format: string, query: Json): Promise<Response> {
    const parameters = Object.entries({ crs: 'native', ...query, f: format }).map(([k, v]): [string, string] => [k, String(v)]);
    return opened(`${this.base}/${question}?${new URLSearchParams(parameters)}`);
  }

  private async asked(question: string, query: Json): Promise<{ json: Json; cost: string }> {
    const response = await this.answered(question, 'json', query);
    return { json: await response.json() as Json, cost: costOf(response) };
  }
}

type Json = Record<string, unknown>;

function pointText(at: MapPosition): string {
  return `POINT(${at.x} ${at.y})`;
}

function lineText(line: Parameters<typeof cornersOf>[0]): string {
  return `LINESTRING(${cornersOf(line).map((p) => `${p.x} ${p.y}`).join(', ')})`;
}

/** The certainty of an answer; what the service does not know, or does not tell, is null. */
export function certaintyOf(json: Json): Certainty {
  const told = (value: unknown): number | null => (typeof value === 'number' ? value : null);
  return { of: 'terrain', error: told(json.certified_error), deviation: told(json.certified_deviation), isExact: json.exact === true };
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
