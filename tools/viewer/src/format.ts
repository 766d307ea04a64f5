// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers for people.
import type { Lengths } from './answers';

/** So many significant digits. */
export function rounded(value: number, digits: number): number {
  return Number(value.toPrecision(digits));
}

function grouped(digits: string): string {
  return digits.replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** So many significant digits, without an exponent, with thin spaces between thousands. */
export function number(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const places = Math.max(0, Math.min(12, digits - 1 - Math.floor(Math.log10(Math.abs(value)))));
  const [whole, part] = Math.abs(value).toFixed(places).split('.');
  return (value < 0 ? '\u2212' : '') + (whole.length > 4 ? grouped(whole) : whole) + (part === undefined ? '' : `.${part}`);
}

/** A number as number() writes it, but never below the value: for bounds. */
export function bound(value: number, digits = 3): string {
  if (!(value > 0) || !Number.isFinite(value)) return number(value, digits);
  const step = 10 ** (Math.floor(Math.log10(value)) - digits + 1);
  const up = Math.ceil(value / step * (1 - 1e-12)) * step;
  return number(up, digits);
}

export function count(value: number): string {
  return grouped(String(Math.round(value)));
}

export function bytes(value: number): string {
  if (value < 1000) return `${value} B`;
  if (value < 1e6) return `${number(value / 1e3, 3)} KB`;
  return `${number(value / 1e6, 3)} MB`;
}

/** The short sign of a unit, for labels. */
export function signOf(unit: string): string {
  if (unit === 'metre' || unit === 'unknown') return 'm';
  if (/foot|feet/.test(unit)) return 'ft';
  if (unit === 'degree') return '°';
  return unit;
}

/** A length given in metres. */
export function metres(value: number): string {
  return Math.abs(value) >= 1000 ? `${number(value / 1000, 4)} km` : `${number(value, 3)} m`;
}

/** A length in a unit of which the metres may not be known. */
export function length(value: number, lengths: Lengths): string {
  return lengths.metres === null ? `${number(value, 4)} map units` : metres(value * lengths.metres);
}

function placesFor(uncertainty: number): number {
  return uncertainty > 0 ? Math.max(0, Math.min(3, 1 - Math.floor(Math.log10(uncertainty)))) : 2;
}

/** A height with a decimal place that its uncertainty deserves; Infinity: not known. */
export function height(value: number, uncertainty: number, sign: string): string {
  return `${value.toFixed(placesFor(uncertainty)).replace('-', '\u2212')} ${sign}`;
}

/** The ends of an interval, rounded outwards. */
export function interval(least: number, most: number, sign: string): [string, string] {
  const uncertainty = most - least;
  const unit = 10 ** placesFor(uncertainty);
  return [height(Math.floor(least * unit) / unit, uncertainty, sign), height(Math.ceil(most * unit) / unit, uncertainty, sign)];
}

/** A place of the map, with as many decimals as its unit deserves. */
export function coordinates(x: number, y: number, isDegrees: boolean, places = 5): string {
  if (!isDegrees) return `${count(x)} E  ${count(y)} N`.replace(/-/g, '\u2212');
  // A terrain across the antimeridian goes on beyond 180.
  if (Math.abs(x) > 180) x -= 360 * Math.round(x / 360);
  return `${Math.abs(y).toFixed(places)}° ${y < 0 ? 'S' : 'N'}  ${Math.abs(x).toFixed(places)}° ${x < 0 ? 'W' : 'E'}`;
}

/** The largest of 1, 2, 5 times a power of ten that is at most `value`. */
export function roundBelow(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].map((n) => n * power).find((n) => n <= value * 1.0000001) ?? power;
}
