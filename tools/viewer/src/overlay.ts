// SPDX-License-Identifier: GPL-3.0-or-later
//
// Labels over the picture, once it rests: heights along index contours, and peaks.
import type { Window } from 'ptin-decoder';
import { signOf } from './format';
import type { Frame } from './frame';
import {
  apart, type Box, type ContourPiece, contourLabels, drawLabels, indexContours, type Label, type LabelledMesh, type Peak, peakLabels,
} from './labels';
import { part } from './page';
import type { Peaks } from './peaks';
import type { Projected } from './projected';
import type { Place } from './relief';

/** The picture that the overlay is drawn over. */
export interface Picture {
  canvas: HTMLCanvasElement;
  frame(): Frame | null;
  project(place: Place): Projected;
  /** The place of the terrain under a point of the picture, CSS pixels; null: none. */
  pick(x: number, y: number): Place | null;
  /** How far a place is from the camera. */
  distance(place: Place): number;
  /** The parts of the terrain that are seen: all of it, and what is nearer. */
  windows(): Window[];
  interval(): number;
}

/** Milliseconds without a drawing after which the picture rests. */
const rest = 350;

export class Overlay {
  labels: Label[] = [];
  private mesh: LabelledMesh | null = null;
  private pieces: { of: LabelledMesh; interval: number; all: ContourPiece[] } | null = null;
  private peaks: Peak[] = [];
  private timer = 0;
  private round = 0;
  private isShown = false;

  /** @param summits  Null where nobody knows of peaks. */
  constructor(private readonly picture: Picture, private readonly summits: Peaks | null) {}

  setMesh(mesh: LabelledMesh): void {
    this.mesh = mesh;
  }

  /** The picture is drawn: what is written over the last one goes, and comes again when this one rests. */
  drawn(): void {
    ++this.round;
    if (this.isShown) drawLabels(part('labels'), []);
    this.isShown = false;
    this.labels = [];
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => { void this.layOut(); }, rest);
  }

  private async layOut(): Promise<void> {
    const frame = this.picture.frame();
    if (frame === null || this.mesh === null) return;
    const { round } = this;
    this.write(frame);
    if (this.summits === null) return;
    const found = await this.summits.within(this.picture.windows(), frame.bounds);
    if (round !== this.round) return;
    const least = frame.facts.minHeight + 0.1 * (frame.facts.maxHeight - frame.facts.minHeight);
    this.peaks = found.filter((p) => p.height > least).map(({ x, y, height }) => ({
      place: { x: frame.sceneX(x), y: frame.sceneY(y), z: frame.sceneZ(height) }, height,
    }));
    this.write(frame);
  }

  private write(frame: Frame): void {
    const { picture } = this;
    const { clientWidth: width, clientHeight: height } = picture.canvas;
    const size = { width, height };
    const sign = signOf(frame.units.height);
    const project = (place: Place): Projected => picture.project(place);
    const all = apart([
      ...peakLabels(this.peaks, project, sign), ...contourLabels(this.contours(frame), project, size, sign),
    ], size, panelsOver(picture.canvas));
    this.labels = all.filter((label) => this.isInSight(label));
    drawLabels(part('labels'), this.labels);
    this.isShown = true;
  }

  private contours(frame: Frame): ContourPiece[] {
    const { mesh } = this;
    const interval = this.picture.interval();
    if (mesh === null || !(interval > 0)) return [];
    if (this.pieces?.of !== mesh || this.pieces.interval !== interval) {
      this.pieces = { of: mesh, interval, all: indexContours(mesh, frame, interval) };
    }
    return this.pieces.all;
  }

  /** Nothing much nearer hides the place that a label is of. */
  private isInSight(label: Label): boolean {
    const y = label.kind === 'peak' ? label.y + 2 : label.y;
    const place = this.picture.pick(label.x, y);
    if (place === null) return label.kind === 'peak';
    return this.picture.distance(place) > 0.97 * this.picture.distance(label.of);
  }
}

/** The panels that stand over the picture. */
function panelsOver(canvas: HTMLCanvasElement): Box[] {
  const { left, top } = canvas.getBoundingClientRect();
  return [...document.querySelectorAll('.glass')].map((panel) => panel.getBoundingClientRect())
    .filter((box) => box.width > 0)
    .map((box) => ({ x: box.x + box.width / 2 - left, y: box.y + box.height / 2 - top, w: box.width / 2, h: box.height / 2 }));
}
