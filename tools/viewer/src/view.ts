// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the camera stands, how it moves, the permalink's part, and the detail that its picture shows. It stays above the ground.
import type { Certified, Wanted, Window } from 'ptin-decoder';
import { certifiedAt, widened, windowAround } from 'ptin-decoder/values';
import type { Frame } from './frame';
import type { Place } from './marks';
import type { Projected } from './projected';
import { type Camera, difference, lengthOf, sum, type Triple, turnedAround } from './space';
import type { Spread } from './surface_raster';

/** The place that the camera looks at on the map, from how far, and in which direction, in metres and degrees. */
export interface Pose {
  x: number;
  y: number;
  /** The height of the place looked at, in its unit. */
  height: number;
  distance: number;
  /** Clockwise from north. */
  heading: number;
  /** From straight down. */
  tilt: number;
}

/** The ground of the picture, without exaggeration. */
export interface Surface {
  /** z at a place; null where there is none. */
  groundAt(x: number, y: number): number | null;
  /** The share of a way at which the ground is met; null where it is not. */
  meets(from: Triple, way: Triple): number | null;
  /** Whether `test` holds for one of the boxes that hold the ground of an extent, where its z may be off by `slack`. */
  someBox(extent: Window, slack: number, test: (least: Triple, most: Triple) => boolean): boolean;
}

/** A point of the picture, from -1 to 1: to the right, up. */
export interface Point {
  x: number;
  y: number;
}

/** Light and colours show steps that no silhouette does: so many of them are told apart in the whole relief. */
const leastSteps = 150;
/** Degrees from straight down: near the horizon, and never above it. */
const mostTilt = 86;
/** The view of the whole terrain: north at the upper left, so that its depth is seen. */
const homeHeading = 345, homeTilt = 56;
/** What a home view without the terrain's summit is worth less: as much as a tenth of the picture without ground. */
const withoutSummit = 0.1;
/** The place looked at is no farther from the middle, in extents of the terrain. */
const mostAside = 0.6;
/** Milliseconds of a flight. */
const flightTime = 420;

const radians = Math.PI / 180;

export class View {
  /** Told whenever the camera moved. */
  changed: () => void = () => undefined;
  /** The nearest and the farthest from what is looked at, metres. */
  leastDistance = 1;
  mostDistance = 1e7;
  private frame: Frame | null = null;
  private home: Pose | null = null;
  private factor = 1;
  private target: Triple = [0, 0, 0];
  private flight: { from: Pose; to: Pose; begin: number } | null = null;
  private readonly still = matchMedia('(prefers-reduced-motion: reduce)');

  constructor(readonly camera: Camera, private readonly surface: Surface) {}

  /** How many times as high as it is the terrain is drawn. What is looked at stays in the middle. */
  get exaggeration(): number { return this.factor; }
  set exaggeration(factor: number) {
    const rise = this.target[2] * (factor / this.factor - 1);
    this.factor = factor;
    this.move([0, 0, rise]);
  }

  /** How far the place looked at is, metres. */
  get distance(): number { return lengthOf(difference(this.camera.position, this.target)); }
  /** The place looked at, in the scene. */
  get lookedAt(): Triple { return this.target; }

  setFrame(frame: Frame): void {
    this.frame = frame;
    const extent = Math.hypot(frame.width, frame.depth);
    this.leastDistance = extent / 5000;
    this.mostDistance = extent * 6;
    this.home = {
      x: frame.middleX, y: frame.middleY, height: frame.heightAt(0.35 * frame.relief), distance: 0.5 * extent, heading: homeHeading,
      tilt: homeTilt,
    };
    this.reset();
  }

  /** Has another frame of the same terrain, a little more exact; the camera stays over its place on the map. */
  replaceFrame(frame: Frame): void {
    const { current } = this;
    this.frame = frame;
    if (current !== null) this.place(current);
  }

  /**
   * Goes where the ground fills the picture, which lies within an extent of the scene, and has its summit; `z`: its middle height. This
   * is the home.
   */
  fillWith(extent: { west: number; south: number; east: number; north: number }, z: number, summit: Triple | null = null): void {
    const { frame } = this;
    if (frame === null) return;
    const x = (extent.west + extent.east) / 2, y = (extent.south + extent.north) / 2;
    const whole = Math.hypot(extent.east - extent.west, extent.north - extent.south);
    // A tall picture is filled by ground that is seen from higher up.
    const tilt = homeTilt - 12 * Math.max(0, Math.min(1, 2 * (1 - this.camera.aspect)));
    let best = -Infinity;
    // The picture is to be full, and to show much.
    for (let distance = 0.36 * whole; distance < 0.9 * whole; distance *= 1.08) {
      for (const ahead of [-0.12, -0.06, 0, 0.06]) {
        const pose = moved(frame, {
          x: frame.mapX(x), y: frame.mapY(y), height: frame.heightAt(z), distance, heading: homeHeading, tilt,
        }, 0, ahead * whole);
        this.place(pose);
        const top = summit === null ? null : this.camera.project([summit[0], summit[1], summit[2] * this.factor]);
        const hasSummit = summit === null || (top !== null && Math.abs(top.x) < 0.95 && Math.abs(top.y) < 0.9);
        const merit = this.fullness(z * this.factor) + 0.36 * Math.log(distance / whole) - (hasSummit ? 0 : withoutSummit);
        if (merit > best) [best, this.home] = [merit, pose];
      }
    }
    this.reset();
  }

  /** The share of the picture below its upper sixth in which there is ground of a middle height. */
  private fullness(z: number): number {
    const { camera } = this;
    const across = 12, rows = 10;
    let met = 0;
    for (let i = 0; i <= across; ++i) {
      for (let j = 0; j <= rows; ++j) {
        const ray = camera.ray(2 * i / across - 1, 1.66 * j / rows - 1);
        if (ray[2] >= 0) continue;
        const [px, py] = sum(camera.position, ray, (z - camera.position[2]) / ray[2]);
        if (this.surface.groundAt(px, py) !== null) ++met;
      }
    }
    return met / ((across + 1) * (rows + 1));
  }

  reset(): void {
    if (this.home !== null) this.pose(this.home);
  }

  pose(pose: Pose): void {
    this.flight = null;
    this.place(pose);
    this.changed();
  }

  private place(pose: Pose): void {
    const { frame, camera } = this;
    if (frame === null) return;
    // Whatever a link or a key wants, the terrain stays within reach.
    const clamp = (v: number, least: number, most: number): number => Math.max(least, Math.min(most, v));
    const { width, depth, relief } = frame;
    this.target = [
      clamp(frame.sceneX(pose.x), -mostAside * width, mostAside * width), clamp(frame.sceneY(pose.y), -mostAside * depth, mostAside * depth),
      clamp(frame.sceneZ(pose.height), -relief, 2 * relief) * this.factor,
    ];
    camera.heading = pose.heading * radians;
    camera.tilt = Math.max(0, Math.min(mostTilt, pose.tilt)) * radians;
    camera.position = sum(this.target, camera.forward, -clamp(pose.distance, this.leastDistance, this.mostDistance));
  }

  /** The pose now. */
  get current(): Pose | null {
    const { frame, target, camera } = this;
    if (frame === null) return null;
    return {
      x: frame.mapX(target[0]), y: frame.mapY(target[1]), height: frame.heightAt(target[2] / this.factor), distance: this.distance,
      heading: (camera.heading / radians % 360 + 360) % 360, tilt: camera.tilt / radians,
    };
  }

  /** Goes to a pose, in a moment unless the user wants no motion. */
  flyTo(to: Pose): void {
    const from = this.current;
    if (from === null) return;
    if (this.still.matches) this.pose(to);
    else this.flight = { from, to, begin: performance.now() };
    this.changed();
  }

  flyHome(): void {
    if (this.home !== null) this.flyTo(this.home);
  }

  /** Turns until north is up. */
  turnNorth(): void {
    const { current } = this;
    if (current !== null) this.flyTo({ ...current, heading: 0 });
  }

  /** Before a picture: goes on with a flight, and stays out of the ground. True while the camera still moves. */
  update(): boolean {
    const { frame, flight } = this;
    if (frame === null) return false;
    if (flight !== null) {
      const share = Math.min(1, (performance.now() - flight.begin) / flightTime);
      this.place(between(flight.from, flight.to, share * share * (3 - 2 * share)));
      if (share === 1) this.flight = null;
      this.changed();
    }
    this.stayAbove(frame);
    this.clip(frame);
    return this.flight !== null;
  }

  /** Lifts the camera out of the ground, and over the lowest ground beside the terrain. It looks at the same place as before. */
  private stayAbove(frame: Frame): void {
    const { camera } = this;
    const [x, y, z] = camera.position;
    const least = Math.max(1.2e-4 * Math.hypot(frame.width, frame.depth), 0.02 * this.distance);
    if (z >= frame.relief * this.factor + least) return;
    let ground = 0;
    for (const [east, north] of [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]) {
      ground = Math.max(ground, (this.surface.groundAt(x + least * east, y + least * north) ?? 0) * this.factor);
    }
    if (z >= ground + least) return;
    camera.position = [x, y, ground + least];
    const way = difference(this.target, camera.position);
    const flat = Math.hypot(way[0], way[1]);
    if (flat > 1e-9) camera.heading = Math.atan2(way[0], way[1]);
    camera.tilt = Math.min(mostTilt * radians, Math.atan2(flat, -way[2]));
    this.target = sum(camera.position, camera.forward, Math.max(this.leastDistance, lengthOf(way)));
  }

  /** Near and far are around the terrain, wherever the camera is. */
  private clip(frame: Frame): void {
    const { camera } = this;
    const away = lengthOf(camera.position);
    const clearance = camera.position[2] - (this.surface.groundAt(camera.position[0], camera.position[1]) ?? 0) * this.factor;
    camera.near = Math.max(0.05, Math.min(this.distance, Math.max(clearance, 0)) / 20);
    camera.far = away + 2 * Math.hypot(frame.width, frame.depth, frame.relief * this.factor);
  }

  /** The place of the scene at a point of the picture, exaggerated: on the ground, or on a plane through what is looked at. */
  private placeAt({ x, y }: Point): Triple {
    const { camera, factor } = this;
    const ray = camera.ray(x, y);
    const [px, py, pz] = camera.position;
    const share = this.surface.meets([px, py, pz / factor], [ray[0], ray[1], ray[2] / factor]);
    if (share !== null) return sum(camera.position, ray, share);
    return this.onPlane(ray, this.target[2]);
  }

  /** Where a ray meets a level; along a flat one not farther than twice what is looked at. */
  private onPlane(ray: Triple, z: number): Triple {
    const { camera } = this;
    const share = (z - camera.position[2]) / ray[2];
    return sum(camera.position, ray, share > 0 ? Math.min(share, 2 * this.distance) : 2 * this.distance);
  }

  private move(way: Triple): void {
    this.target = sum(this.target, way);
    this.camera.position = sum(this.camera.position, way);
  }

  /** Has what was at a point of the picture come to another one. `z`: the level that moves (`levelAt`). */
  drag(from: Point, to: Point, z: number): void {
    const { frame, camera } = this;
    if (frame === null) return;
    this.flight = null;
    const [x, y] = difference(this.onPlane(camera.ray(from.x, from.y), z), this.onPlane(camera.ray(to.x, to.y), z));
    const clamp = (v: number, most: number): number => Math.max(-most, Math.min(most, v));
    this.move([
      clamp(this.target[0] + x, mostAside * frame.width) - this.target[0], clamp(this.target[1] + y, mostAside * frame.depth) - this.target[1], 0,
    ]);
    this.changed();
  }

  /** The level of the ground at a point of the picture. */
  levelAt(point: Point): number { return this.placeAt(point)[2]; }

  /** The place that the camera goes round, at a point of the picture. */
  pivotAt(point: Point): Triple { return this.placeAt(point); }

  /** Goes round a place: degrees that the heading and the tilt grow by. */
  orbit(pivot: Triple, turn: number, tilt: number): void {
    const { camera } = this;
    this.flight = null;
    const most = Math.max(-camera.tilt, Math.min(mostTilt * radians - camera.tilt, tilt * radians));
    const around = (axis: Triple, angle: number): void => {
      camera.position = sum(pivot, turnedAround(difference(camera.position, pivot), axis, angle));
      this.target = sum(pivot, turnedAround(difference(this.target, pivot), axis, angle));
    };
    around(camera.right, most);
    camera.tilt += most;
    around([0, 0, 1], -turn * radians);
    camera.heading += turn * radians;
    this.changed();
  }

  /** After a gesture: what is looked at is the ground in the picture's middle. */
  settle(): void {
    const { camera, factor } = this;
    const [x, y, z] = camera.position, ray = camera.forward;
    const share = this.surface.meets([x, y, z / factor], [ray[0], ray[1], ray[2] / factor]);
    if (share !== null && share > this.leastDistance && share < this.mostDistance) this.target = sum(camera.position, ray, share);
  }

  /** Nearer to what is at a point of the picture, or farther from it: `factor` of the way is left. */
  zoomAt(point: Point, factor: number): void {
    this.flight = null;
    const pivot = this.placeAt(point);
    const away = lengthOf(difference(this.camera.position, pivot));
    const share = Math.max(Math.min(1, this.leastDistance / away), Math.min(factor, Math.max(1, this.mostDistance / this.distance)));
    this.camera.position = sum(pivot, difference(this.camera.position, pivot), share);
    this.target = sum(pivot, difference(this.target, pivot), share);
    this.settle();
    this.changed();
  }

  /**
   * Which windows of the map are in the picture, or may be: the terrain is as far from the ground of the picture as is certified there,
   * and where nothing is it may be anywhere in the relief.
   */
  seenWindows(frame: Frame, certified: Certified): (window: Window) => boolean {
    const { surface } = this;
    const mayMeet = this.camera.sight(this.factor);
    return ([west, south, east, north]) => {
      const extent: Window = [frame.sceneX(west), frame.sceneY(south), frame.sceneX(east), frame.sceneY(north)];
      // Most windows are beyond a side of the picture at any height.
      if (!mayMeet([extent[0], extent[1], 0], [extent[2], extent[3], frame.relief])) return false;
      const deviation = certifiedAt(certified, [{ x: (west + east) / 2, y: (south + north) / 2 }])?.deviation ?? Infinity;
      if (!(deviation * frame.scaleZ < frame.relief)) return true;
      return surface.someBox(extent, deviation * frame.scaleZ, mayMeet);
    };
  }

  /** How far a place of the scene, without exaggeration, is from the camera. */
  distanceTo({ x, y, z }: Place): number { return lengthOf(difference(this.camera.position, [x, y, z * this.factor])); }

  /**
   * Where a place of the scene, without exaggeration, is on the page's canvas, in pixels; `visible`: it is in the picture. What may
   * hide it is not asked.
   */
  project(x: number, y: number, z: number): Projected {
    const { camera } = this;
    const at = camera.project([x, y, z * this.factor]);
    if (at === null) return { x: 0, y: 0, visible: false };
    return {
      x: (at.x + 1) / 2 * camera.width, y: (1 - at.y) / 2 * camera.height, visible: Math.abs(at.x) <= 1 && Math.abs(at.y) <= 1,
    };
  }

  /** The direction across the picture, on the ground of the scene. */
  get across(): Triple { return this.camera.right; }

  /** To the right and away from the camera: shares of the picture. */
  pan(right: number, ahead: number): void {
    this.change((now, frame) => moved(frame, now, 0.12 * now.distance * right, 0.12 * now.distance * ahead));
  }

  zoom(factor: number): void {
    this.change((now) => ({ ...now, distance: Math.min(this.mostDistance, Math.max(this.leastDistance, now.distance * factor)) }));
  }

  /** Degrees: the camera goes round to the left of the picture. */
  turn(degrees: number): void {
    this.change((now) => ({ ...now, heading: now.heading - degrees }));
  }

  /** Degrees: more looks farther towards the horizon. */
  tilt(degrees: number): void {
    this.change((now) => ({ ...now, tilt: Math.max(0, Math.min(mostTilt, now.tilt + degrees)) }));
  }

  private change(next: (now: Pose, frame: Frame) => Pose): void {
    const { current, frame } = this;
    if (current !== null && frame !== null) this.pose(next(current, frame));
  }

  /** Metres that a pixel shows at a distance, for a canvas of so many pixels in height. */
  metresPerPixel(distance: number, pixels: number): number {
    return 2 * distance * this.camera.halfHeight / Math.max(1, pixels);
  }

  /**
   * The detail that the picture needs: for each octave of distance the part of the terrain that is at most so far, and the error that is
   * `tolerance` pixels there. The coarsest part first. `slack`: by how much the ground of the picture may be off in z; 0: nobody
   * knows.
   */
  wanted(pixels: number, tolerance: number, slack = 0): Wanted[] {
    const { frame } = this;
    if (frame === null) return [];
    const met = this.seenPlaces(frame);
    const seen = slack > 0 && met.length > 0 ? [...met, ...this.placesBeyond(met, frame, slack)] : met;
    const nearest = Math.min(...seen.map((s) => s.distance));
    const farthest = Math.max(...seen.map((s) => s.distance), nearest);
    const parts: Wanted[] = [];
    for (let reach = farthest; seen.length !== 0; reach /= 2) {
      const within = seen.filter((s) => s.distance <= reach * 1.001);
      const window = windowAround(within.map((p) => ({ x: frame.mapX(p.x), y: frame.mapY(p.y) })));
      const at = Math.max(reach / 2, nearest);
      const error = tolerance * this.metresPerPixel(at, pixels) / this.exaggeration;
      parts.push({ window, error: Math.min(error, frame.relief / leastSteps) / frame.scaleZ });
      if (reach / 2 <= nearest) break;
    }
    return parts;
  }

  /**
   * Places that no ray met and that the picture may show all the same, behind a ridge, say: they are as far as the farthest that was
   * met, at least. Without them nothing better than the first coarse answer would be certified of all that may be in sight.
   */
  private placesBeyond(met: readonly SeenPlace[], frame: Frame, slack: number): SeenPlace[] {
    const { camera, factor } = this;
    const mayMeet = camera.sight(factor);
    const farthest = Math.max(...met.map((p) => p.distance));
    const half: Window = [-frame.width / 2, -frame.depth / 2, frame.width / 2, frame.depth / 2];
    const known = widened(windowAround(met), half, 1 / 8);
    const beyond: SeenPlace[] = [];
    this.surface.someBox(half, slack, (least, most) => {
      const isKnown = least[0] >= known[0] && least[1] >= known[1] && most[0] <= known[2] && most[1] <= known[3];
      if (isKnown || !mayMeet(least, most)) return false;
      for (const [x, y] of [least, most]) {
        beyond.push({ x, y, distance: Math.max(farthest, lengthOf(difference(camera.position, [x, y, most[2] * factor]))) });
      }
      return false;
    });
    return beyond;
  }

  /**
   * Places of the terrain under points of the picture, and how far they are: on the ground; where a ray meets none, since it goes through
   * a void or nothing is there yet, at its middle height.
   */
  private seenPlaces(frame: Frame): SeenPlace[] {
    const places = [];
    const middle = 0.4 * frame.relief * this.exaggeration;
    const { camera, factor, surface } = this;
    const [px, py, pz] = camera.position;
    const columns = 12, rows = 12;
    for (let i = 0; i <= columns; ++i) {
      for (let j = 0; j <= rows; ++j) {
        const ray = camera.ray(2 * i / columns - 1, 2 * j / rows - 1);
        const ground = surface.meets([px, py, pz / factor], [ray[0], ray[1], ray[2] / factor]);
        if (ground !== null) {
          places.push({ x: px + ray[0] * ground, y: py + ray[1] * ground, distance: ground });
          continue;
        }
        const reach = ray[2] < -1e-3 ? (middle - pz) / ray[2] : Infinity;
        const distance = Math.min(reach > 0 ? reach : camera.far, camera.far);
        const x = px + ray[0] * distance, y = py + ray[1] * distance;
        const inX = Math.max(-frame.width / 2, Math.min(frame.width / 2, x));
        const inY = Math.max(-frame.depth / 2, Math.min(frame.depth / 2, y));
        if (Math.hypot(x - inX, y - inY) > 0.3 * Math.hypot(frame.width, frame.depth) && reach !== Infinity) continue;
        places.push({ x: inX, y: inY, distance: lengthOf(difference(camera.position, [inX, inY, middle])) });
      }
    }
    return places;
  }
}

/** A place of the scene that is in the picture, and how far it is. */
interface SeenPlace {
  x: number;
  y: number;
  distance: number;
}

/** A pose moved over the ground: metres to the right of the picture, and away from the camera. */
function moved(frame: Frame, pose: Pose, right: number, ahead: number): Pose {
  const sine = Math.sin(pose.heading * radians), cosine = Math.cos(pose.heading * radians);
  return {
    ...pose, x: pose.x + (right * cosine + ahead * sine) / frame.scaleX, y: pose.y + (ahead * cosine - right * sine) / frame.scaleY,
  };
}

/** A pose on the way between two, which turns the shorter way round. */
function between(from: Pose, to: Pose, share: number): Pose {
  const mix = (a: number, b: number): number => a + share * (b - a);
  const turn = ((to.heading - from.heading) % 360 + 540) % 360 - 180;
  return {
    x: mix(from.x, to.x), y: mix(from.y, to.y), height: mix(from.height, to.height), distance: from.distance * (to.distance / from.distance) ** share,
    heading: from.heading + share * turn, tilt: mix(from.tilt, to.tilt),
  };
}

/** Steps in which people read a factor. */
const factors = [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10, 12];

/** How many times as high as it is a terrain is drawn where its user says nothing: lowland more, high mountains little or not. */
export function usualExaggeration(frame: Frame, spread: Spread): number {
  const extent = Math.sqrt(frame.width * frame.depth);
  const wanted = (0.15 * extent / Math.max(spread.most - spread.least, 1e-6)) ** 0.55;
  return [...factors].reverse().find((factor) => factor <= wanted * 1.08) ?? 1;
}
