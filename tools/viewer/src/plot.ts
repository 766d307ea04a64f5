// SPDX-License-Identifier: GPL-3.0-or-later
//
// A profile as a drawing and as CSV.
import type { Lengths, Profile } from './answers';
import type { DrawnSight } from './drawn_sight';
import { height as heightText, length as lengthText, roundBelow, rounded } from './format';
import { extentOf, heightAlong, heightsOf, runsOf } from './stations';

const namespace = 'http://www.w3.org/2000/svg';

function element(name: string, attributes: Record<string, string | number>, text = ''): SVGElement {
  const made = document.createElementNS(namespace, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.textContent = text;
  return made;
}

export interface PlotOptions {
  profile: Profile;
  heightSign: string;
  /** Infinity: not known. */
  deviation: number;
  /** A line of sight over the profile. */
  ray?: DrawnSight & { colour: string };
}

const left = 46, right = 22, top = 12, bottom = 24;

/** Draws into `svg`, anew. Heights have the plot's own scale. */
export function drawPlot(svg: SVGSVGElement, options: PlotOptions): void {
  const { ray } = options;
  const { stations, length, lengths } = options.profile;
  const { width, height } = svg.getBoundingClientRect();
  svg.replaceChildren();
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  const known = heightsOf(stations);
  if (known.length === 0) return;
  const shares = Array.from({ length: 65 }, (_, i) => i / 64);
  const rays = ray === undefined ? [] : shares.flatMap((s) => [ray.at(s) + ray.radius(s), ray.at(s) - ray.radius(s)]);
  const [low, high] = extentOf(known.concat(rays));
  const slack = 0.08 * Math.max(high - low, 1e-6);
  const x = (distance: number): number => left + (distance / length) * (width - left - right);
  const y = (value: number): number =>
    height - bottom - ((value - low + slack) / (high - low + 2 * slack)) * (height - top - bottom);
  drawAxes(svg, { x, y, low, high, length, lengths, width, height, sign: options.heightSign });
  for (const run of runsOf(stations)) {
    const points = run.map((s) => `${x(s.distance).toFixed(1)},${y(s.height as number).toFixed(1)}`);
    const floor = height - bottom;
    svg.append(
      element('polygon', {
        class: 'ground', points: `${x(run[0].distance)},${floor} ${points.join(' ')} ${x(run[run.length - 1].distance)},${floor}`,
      }),
      element('polyline', { class: 'surface', points: points.join(' ') }));
  }
  if (ray !== undefined) drawRay(svg, ray, shares, length, x, y);
  addCursor(svg, options, x, y);
}

function drawRay(
  svg: SVGSVGElement, ray: NonNullable<PlotOptions['ray']>, shares: number[], length: number, x: (d: number) => number,
  y: (h: number) => number,
): void {
  const upper = shares.map((s) => `${x(s * length)},${y(ray.at(s) + ray.radius(s))}`);
  const lower = [...shares].reverse().map((s) => `${x(s * length)},${y(ray.at(s) - ray.radius(s))}`);
  svg.append(
    element('polygon', { points: [...upper, ...lower].join(' '), fill: ray.colour, opacity: 0.2 }),
    element('polyline', {
      points: shares.map((s) => `${x(s * length)},${y(ray.at(s))}`).join(' '), fill: 'none', stroke: ray.colour,
      'stroke-width': 1.6,
    }));
}

function drawAxes(svg: SVGSVGElement, a: {
  x: (d: number) => number; y: (h: number) => number; low: number; high: number; length: number; lengths: Lengths;
  width: number; height: number; sign: string;
}): void {
  const heightStep = roundBelow(Math.max(a.high - a.low, 1e-6) / 2.2);
  for (let h = Math.ceil(a.low / heightStep) * heightStep; h <= a.high; h += heightStep) {
    svg.append(
      element('line', { class: 'grid', x1: left, x2: a.width - right, y1: a.y(h), y2: a.y(h) }),
      element('text', { x: left - 6, y: a.y(h) + 4, 'text-anchor': 'end' }, String(rounded(h, 6))));
  }
  const metre = a.lengths.metres ?? 1;
  const metres = a.length * metre;
  // As many as do not touch.
  const step = roundBelow(metres / Math.max(1, Math.min(3, Math.floor((a.width - left - right) / 85))));
  const isNarrow = (a.width - left - right) * step / metres < 60;
  const inKilometres = a.lengths.metres !== null && metres >= 2000;
  for (let d = isNarrow ? step : 0; d <= metres; d += isNarrow ? 2 * step : step) {
    const label = inKilometres ? `${rounded(d / 1000, 4)} km` : `${rounded(d, 4)}${a.lengths.metres === null ? '' : ' m'}`;
    svg.append(element('text', { x: a.x(d / metre), y: a.height - 7, 'text-anchor': d === 0 ? 'start' : 'middle' }, label));
  }
  svg.append(element('text', { x: left - 6, y: a.height - 7, 'text-anchor': 'end' }, a.sign));
}

function addCursor(svg: SVGSVGElement, options: PlotOptions, x: (d: number) => number, y: (h: number) => number): void {
  const cursor = element('g', { class: 'cursor', visibility: 'hidden' });
  const dot = element('circle', { r: 4 });
  const label = element('text', { y: top + 2, 'text-anchor': 'middle' });
  cursor.append(dot, label);
  svg.append(cursor);
  svg.onpointermove = (event): void => {
    const box = svg.getBoundingClientRect();
    const share = (event.clientX - box.left - left) / (box.width - left - right);
    const distance = Math.max(0, Math.min(1, share)) * options.profile.length;
    const value = heightAlong(options.profile.stations, distance);
    cursor.setAttribute('visibility', value === null ? 'hidden' : 'visible');
    if (value === null) return;
    dot.setAttribute('cx', String(x(distance)));
    dot.setAttribute('cy', String(y(value)));
    label.setAttribute('x', String(Math.max(left + 60, Math.min(box.width - 70, x(distance)))));
    label.textContent = `${lengthText(distance, options.profile.lengths)}, ${heightText(value, options.deviation, options.heightSign)}`;
  };
  svg.onpointerleave = (): void => { cursor.setAttribute('visibility', 'hidden'); };
}

/**
 * One line a station, with place and distance as they came; a gap is a line without a height. Without a deviation nothing is known of
 * the least and the greatest height.
 */
export function csvOf(profile: Profile, deviation: number | null): string {
  const { unit } = profile.lengths;
  const lines = [`distance_${unit === 'metre' ? 'm' : unit.replace(/\W+/g, '_')},x,y,height,height_min,height_max`];
  for (const s of profile.stations) {
    const ends = s.height === null || deviation === null ? ['', ''] : [s.height - deviation, s.height + deviation];
    lines.push([s.distance, s.x, s.y, s.height ?? '', ...ends].join(','));
  }
  return lines.join('\n') + '\n';
}
