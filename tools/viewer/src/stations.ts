// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of a profile as the engine has them, as stretches with gaps between: for drawings and in words.
import type { MapPosition } from 'ptin-decoder';
import type { Profile, PointState, Station } from './answers';

/** All corners of a line. */
export function cornersOf({ from, to, via = [] }: { from: MapPosition; to: MapPosition; via?: readonly MapPosition[] }): MapPosition[] {
  return [from, ...via, to];
}

/** Profiles one behind the other as one: where the next begins the last has ended. */
export function joined(legs: ReadonlyArray<Omit<Profile, 'lengths'>>): Omit<Profile, 'lengths'> {
  const stations: Station[] = [];
  let length = 0;
  legs.forEach((leg, i) => {
    // A leg that ends in a gap tells nothing of its end.
    const before = stations[stations.length - 1];
    const hasEnded = before !== undefined && before.height !== null && before.distance < length - 1e-9 * length;
    if (hasEnded) stations.push({ ...before, height: null });
    const isSame = i > 0 && before?.height !== null && leg.stations[0]?.distance === 0 && leg.stations[0].height !== null && !hasEnded;
    for (const s of isSame ? leg.stations.slice(1) : leg.stations) stations.push({ ...s, distance: s.distance + length });
    length += leg.length;
  });
  return { stations, length };
}

/** A gap is a point without a height; one at the end tells nothing. */
export function stationsOf(points: ReadonlyArray<MapPosition & { distance: number; height: number | null; state: PointState }>): Station[] {
  const stations: Station[] = [];
  for (const { distance, x, y, height, state } of points) {
    if (height !== null) stations.push({ distance, x, y, height });
    if (state !== 'surface') stations.push({ distance, x, y, height: null });
  }
  while (stations.length !== 0 && stations[stations.length - 1].height === null) stations.pop();
  return stations;
}

/** The heights that are known. */
export function heightsOf(stations: readonly Station[]): number[] {
  return stations.flatMap((s) => (s.height === null ? [] : [s.height]));
}

/** The least and the greatest of some numbers. */
export function extentOf(values: readonly number[]): [number, number] {
  return [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))];
}

/** Stretches without a gap. */
export function runsOf(stations: readonly Station[]): Station[][] {
  const runs: Station[][] = [[]];
  for (const s of stations) {
    if (s.height === null) runs.push([]);
    else runs[runs.length - 1].push(s);
  }
  return runs.filter((run) => run.length > 1);
}

/** The height at a distance; null over a gap. */
export function heightAlong(stations: readonly Station[], distance: number): number | null {
  for (const run of runsOf(stations)) {
    const next = run.findIndex((s) => s.distance >= distance);
    if (next < 0 || distance < run[0].distance) continue;
    const b = run[next], a = run[Math.max(0, next - 1)];
    const part = b.distance > a.distance ? (distance - a.distance) / (b.distance - a.distance) : 0;
    return (a.height as number) + part * ((b.height as number) - (a.height as number));
  }
  return null;
}

/** How far the heights go up and down in all. */
export function climbOf(stations: readonly Station[]): { up: number; down: number } {
  const climb = { up: 0, down: 0 };
  stations.forEach((s, i) => {
    const before = stations[i - 1]?.height ?? null;
    if (s.height === null || before === null) return;
    if (s.height > before) climb.up += s.height - before;
    else climb.down += before - s.height;
  });
  return climb;
}
