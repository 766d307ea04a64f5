// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the camera stands and what it needs: its controls, the permalink's part, and the detail that its picture shows.
import { type Wanted, type Window, windowAround } from 'ptin-decoder';
import { Box3, Frustum, Matrix4, PerspectiveCamera, Vector3 } from 'three';
import { MapControls } from 'three/addons/controls/MapControls.js';
import type { Frame } from './frame';

/** What the camera looks at on the map, from how far, and in which direction, in metres and degrees. */
export interface Pose {
  x: number;
  y: number;
  /** Of the place looked at; in the height's unit. */
  height: number;
  distance: number;
  /** Clockwise from north. */
  heading: number;
  /** From straight down. */
  tilt: number;
}

/** Light and colours show steps that no silhouette does: so many of them are told apart in the whole relief. */
const leastSteps = 150;

const radians = Math.PI / 180;

export class View {
  readonly controls: MapControls;
  private frame: Frame | null = null;
  private home: Pose | null = null;
  private factor = 1;
  private readonly still = matchMedia('(prefers-reduced-motion: reduce)');

  constructor(readonly camera: PerspectiveCamera, canvas: HTMLCanvasElement) {
    this.controls = new MapControls(camera, canvas);
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.maxPolarAngle = 1.5;
  }

  /** How many times as high as it is the terrain is drawn. What is looked at stays in the middle. */
  get exaggeration(): number { return this.factor; }
  set exaggeration(factor: number) {
    const { target } = this.controls;
    const rise = target.z * (factor / this.factor - 1);
    this.factor = factor;
    target.z += rise;
    this.camera.position.z += rise;
  }

  /** `covered`: pixels at the left of the picture that something lies over. */
  setFrame(frame: Frame, width: number, covered: number): void {
    this.frame = frame;
    const extent = Math.hypot(frame.width, frame.depth);
    this.controls.minDistance = extent / 5000;
    this.controls.maxDistance = extent * 6;
    // From near, backwards, until all corners are within what is not covered.
    const free = (width - covered) / width;
    for (let distance = 0.4 * extent; distance < 5 * extent; distance *= 1.05) {
      this.home = this.homeAt(frame, distance, free);
      this.pose(this.home);
      this.clip(frame);
      if (this.isWhole(frame, 1 - 2 * free)) break;
    }
  }

  private homeAt(frame: Frame, distance: number, free: number): Pose {
    const isTall = this.camera.aspect * free < 1;
    const middle: Pose = {
      x: frame.middleX, y: frame.middleY, height: frame.heightAt(0.35 * frame.relief), distance, heading: 340, tilt: isTall ? 42 : 52,
    };
    // The picture's middle is that of what is not covered.
    return moved(frame, middle, (free - 1) / 2 * this.metresPerPixel(distance, 1) * this.camera.aspect, 0);
  }

  /** True when every corner of the terrain is in the picture, right of `left` (-1: its edge). */
  private isWhole(frame: Frame, left: number): boolean {
    this.camera.updateMatrixWorld();
    for (const x of [-frame.width / 2, frame.width / 2]) {
      for (const y of [-frame.depth / 2, frame.depth / 2]) {
        for (const z of [0, frame.relief * this.exaggeration]) {
          const at = new Vector3(x, y, z).project(this.camera);
          if (at.z > 1 || at.x < left + 0.02 || at.x > 0.95 || Math.abs(at.y) > 0.86) return false;
        }
      }
    }
    return true;
  }

  reset(): void {
    if (this.home !== null) this.pose(this.home);
  }

  pose(pose: Pose): void {
    const { frame } = this;
    if (frame === null) return;
    // Straight from above the picture would have no direction.
    const heading = pose.heading * radians, tilt = Math.max(pose.tilt, 0.01) * radians;
    const back = new Vector3(-Math.sin(heading) * Math.sin(tilt), -Math.cos(heading) * Math.sin(tilt), Math.cos(tilt));
    const { target } = this.controls;
    target.set(frame.sceneX(pose.x), frame.sceneY(pose.y), frame.sceneZ(pose.height) * this.exaggeration);
    this.camera.position.copy(target).addScaledVector(back, pose.distance);
    this.controls.update();
  }

  /** The pose now. */
  get current(): Pose | null {
    const { frame } = this;
    if (frame === null) return null;
    const { target } = this.controls;
    const back = this.camera.position.clone().sub(target);
    const distance = back.length();
    return {
      x: frame.mapX(target.x), y: frame.mapY(target.y), height: frame.heightAt(target.z / this.exaggeration), distance,
      heading: (Math.atan2(-back.x, -back.y) / radians + 360) % 360,
      tilt: Math.acos(Math.max(-1, Math.min(1, back.z / distance))) / radians,
    };
  }

  /**
   * Follows the controls; true while they still move. Clips the view around the terrain.
   * `groundAt`: the ground at a place of the scene, not exaggerated; null where there is none.
   */
  update(groundAt: (x: number, y: number) => number | null): boolean {
    this.controls.enableDamping = !this.still.matches;
    const moved = this.controls.update();
    if (this.frame !== null) {
      this.stayWithin();
      this.stayAbove(this.frame, groundAt);
      this.clip(this.frame);
    }
    return moved;
  }

  /**
   * Keeps the camera off its nearest and its farthest by more than a rounding. The controls find a distance that is beyond these by a
   * rounding changed each time, so that the picture would be drawn for ever.
   */
  private stayWithin(): void {
    const { minDistance, maxDistance, target } = this.controls;
    this.camera.position.sub(target).clampLength(minDistance * (1 + 1e-9), maxDistance * (1 - 1e-9)).add(target);
  }

  /** Lifts the camera out of the ground, and over the lowest ground beside the terrain and in voids. */
  private stayAbove(frame: Frame, groundAt: (x: number, y: number) => number | null): void {
    const { position } = this.camera;
    const least = Math.max(2e-5 * this.controls.maxDistance, 0.02 * position.distanceTo(this.controls.target));
    if (position.z >= frame.relief * this.exaggeration + least) return;
    const ground = (groundAt(position.x, position.y) ?? 0) * this.exaggeration;
    if (position.z >= ground + least) return;
    position.z = ground + least;
    this.camera.lookAt(this.controls.target);
  }

  /** Which windows of the map are in the picture, or may be: whatever lies between the least and the greatest height there. */
  seenWindows(frame: Frame): (window: Window) => boolean {
    const { camera } = this;
    camera.updateMatrixWorld();
    const frustum = new Frustum().setFromProjectionMatrix(new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const box = new Box3();
    const top = frame.relief * this.exaggeration;
    return ([west, south, east, north]) => {
      box.min.set(frame.sceneX(west), frame.sceneY(south), 0);
      box.max.set(frame.sceneX(east), frame.sceneY(north), top);
      return frustum.intersectsBox(box);
    };
  }

  /** The direction across the picture, on the ground of the scene. */
  get across(): Vector3 {
    return new Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion).setZ(0).normalize();
  }

  /** Near and far are around the terrain, wherever the camera is. */
  private clip(frame: Frame): void {
    const { camera } = this;
    camera.near = Math.max(camera.position.distanceTo(this.controls.target) / 2000, 0.05);
    camera.far = camera.position.length() + 2 * Math.hypot(frame.width, frame.depth, frame.relief);
    camera.updateProjectionMatrix();
  }

  /** To the right and away from the camera: shares of the picture. */
  pan(right: number, ahead: number): void {
    this.change((now, frame) => moved(frame, now, 0.12 * now.distance * right, 0.12 * now.distance * ahead));
  }

  zoom(factor: number): void {
    const { minDistance, maxDistance } = this.controls;
    this.change((now) => ({ ...now, distance: Math.min(maxDistance, Math.max(minDistance, now.distance * factor)) }));
  }

  /** Degrees: the camera goes round to the left of the picture. */
  turn(degrees: number): void {
    this.change((now) => ({ ...now, heading: now.heading - degrees }));
  }

  /** Degrees: more looks farther towards the horizon. */
  tilt(degrees: number): void {
    const most = this.controls.maxPolarAngle / radians;
    this.change((now) => ({ ...now, tilt: Math.max(0, Math.min(most, now.tilt + degrees)) }));
  }

  private change(next: (now: Pose, frame: Frame) => Pose): void {
    const { current, frame } = this;
    if (current !== null && frame !== null) this.pose(next(current, frame));
  }

  /** Metres that a pixel shows at a distance, for a canvas of so many pixels in height. */
  metresPerPixel(distance: number, pixels: number): number {
    return 2 * distance * Math.tan(this.camera.fov / 2 * radians) / Math.max(1, pixels);
  }

  /**
   * What the picture needs: for each octave of distance the part of the terrain that is at most so far, and the error that is
   * `tolerance` pixels there. The coarsest part first.
   */
  wanted(pixels: number, tolerance: number): Wanted[] {
    const { frame } = this;
    if (frame === null) return [];
    const seen = this.seenPlaces(frame);
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

  /** Places of the terrain's middle height under points of the picture, and how far they are. */
  private seenPlaces(frame: Frame): Array<{ x: number; y: number; distance: number }> {
    const places = [];
    const middle = 0.4 * frame.relief * this.exaggeration;
    const { camera } = this;
    camera.updateMatrixWorld();
    const columns = 12, rows = 12;
    for (let i = 0; i <= columns; ++i) {
      for (let j = 0; j <= rows; ++j) {
        const ray = new Vector3(2 * i / columns - 1, 2 * j / rows - 1, 0.5).unproject(camera).sub(camera.position).normalize();
        const reach = ray.z < -1e-3 ? (middle - camera.position.z) / ray.z : Infinity;
        const distance = Math.min(reach > 0 ? reach : camera.far, camera.far);
        const x = camera.position.x + ray.x * distance, y = camera.position.y + ray.y * distance;
        const inX = Math.max(-frame.width / 2, Math.min(frame.width / 2, x));
        const inY = Math.max(-frame.depth / 2, Math.min(frame.depth / 2, y));
        if (Math.hypot(x - inX, y - inY) > 0.3 * Math.hypot(frame.width, frame.depth) && reach !== Infinity) continue;
        places.push({ x: inX, y: inY, distance: camera.position.distanceTo(new Vector3(inX, inY, middle)) });
      }
    }
    return places;
  }
}

/** A pose moved over the ground: metres to the right of the picture, and away from the camera. */
function moved(frame: Frame, pose: Pose, right: number, ahead: number): Pose {
  const sine = Math.sin(pose.heading * radians), cosine = Math.cos(pose.heading * radians);
  return {
    ...pose, x: pose.x + (right * cosine + ahead * sine) / frame.scaleX, y: pose.y + (ahead * cosine - right * sine) / frame.scaleY,
  };
}
