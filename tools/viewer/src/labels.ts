// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights written over the picture: along contours, and at peaks. Labels are laid out once the camera rests, so that none overlaps
// another; while it moves they are away. Pictures alone: no number that the page tells comes from here.
import { rounded } from './format';
import type { Frame } from './frame';
import type { Projected } from './projected';
import type { Place } from './relief';

/** The mesh that is drawn, as its labels need it. */
export interface LabelledMesh {
  positions: Float32Array;
  corners: Uint32Array;
}

/** A piece of an index contour in the scene, within one triangle, with the way uphill over the ground. */
export interface ContourPiece {
  ax: number; ay: number; bx: number; by: number;
  z: number;
  upX: number; upY: number;
  height: number;
}

/** A label in the picture: CSS pixels, and radians clockwise from upright. */
export interface Label {
  x: number;
  y: number;
  angle: number;
  text: string;
  kind: 'contour' | 'peak';
  /** The place of the scene that it is of. */
  of: Place;
}

export interface Peak {
  place: Place;
  height: number;
}

/** Every fifth of a terrain's contours is bold, and has labels. */
export const indexStep = 5;

/** Pieces of index contours, at most: lines as close as those of more are no lines, and have no labels. */
const mostPieces = 1e6;

/** The pieces of the index contours of a mesh. Cost: its triangles. */
export function indexContours({ positions: p, corners }: LabelledMesh, frame: Frame, interval: number): ContourPiece[] {
  const step = indexStep * interval;
  const pieces: ContourPiece[] = [];
  if (!(step > 0)) return pieces;
  for (let t = 0; t < corners.length; t += 3) {
    const v = [3 * corners[t], 3 * corners[t + 1], 3 * corners[t + 2]].sort((a, b) => p[a + 2] - p[b + 2]);
    const [low, middle, high] = v.map((i) => p[i + 2]);
    if (!(high > low)) continue;
    for (let k = Math.ceil(frame.heightAt(low) / step); k * step < frame.heightAt(high); ++k) {
      if (pieces.length >= mostPieces) return [];
      const z = frame.sceneZ(k * step);
      if (z <= low) continue;
      const on = (a: number, b: number): [number, number] => {
        const share = (z - p[a + 2]) / (p[b + 2] - p[a + 2]);
        return [p[a] + share * (p[b] - p[a]), p[a + 1] + share * (p[b + 1] - p[a + 1])];
      };
      const [ax, ay] = on(v[0], v[2]);
      const [bx, by] = z < middle ? on(v[0], v[1]) : on(v[1], v[2]);
      // Across the piece, to the side of the highest corner.
      const side = Math.sign((bx - ax) * (p[v[2] + 1] - ay) - (by - ay) * (p[v[2]] - ax));
      pieces.push({ ax, ay, bx, by, z, upX: -side * (by - ay), upY: side * (bx - ax), height: k * step });
    }
  }
  return pieces;
}

/** Where labels may stand, and how many fit: one a cell of so many pixels. */
const cellWidth = 190, cellHeight = 130;
/** Half of a label's length along its line, and how far the line may leave it, pixels. */
const half = 20, mostBend = 4.5;

interface Flat {
  x: number;
  y: number;
  piece: ContourPiece;
}

/** Labels along the contours: on stretches that are straight for as long as a label, and upright where the ground rises. */
export function contourLabels(
  pieces: readonly ContourPiece[], project: (place: Place) => Projected, size: { width: number; height: number }, sign: string,
): Label[] {
  const cells = new Map<number, Flat[]>();
  const columns = Math.ceil(size.width / cellWidth);
  for (const piece of pieces) {
    const at = project({ x: (piece.ax + piece.bx) / 2, y: (piece.ay + piece.by) / 2, z: piece.z });
    if (!at.visible) continue;
    const cell = Math.floor(at.y / cellHeight) * columns + Math.floor(at.x / cellWidth);
    const found = cells.get(cell);
    if (found === undefined) cells.set(cell, [{ x: at.x, y: at.y, piece }]);
    else found.push({ x: at.x, y: at.y, piece });
  }
  const labels: Label[] = [];
  for (const [cell, flats] of cells) {
    const x = (cell % columns + 0.5) * cellWidth, y = (Math.floor(cell / columns) + 0.5) * cellHeight;
    const near = [...flats].sort((a, b) => Math.hypot(a.x - x, a.y - y) - Math.hypot(b.x - x, b.y - y));
    for (const at of near.slice(0, 40)) {
      const label = labelAt(at, flats, project, sign);
      if (label === null) continue;
      labels.push(label);
      break;
    }
  }
  return labels;
}

/** The label at a piece; null where its line bends within the label, or is too short or too crowded for one. */
function labelAt(at: Flat, flats: readonly Flat[], project: (place: Place) => Projected, sign: string): Label | null {
  const near = flats.filter((f) => Math.abs(f.x - at.x) < half && Math.abs(f.y - at.y) < half);
  const same = near.filter((f) => f.piece.height === at.piece.height && Math.hypot(f.x - at.x, f.y - at.y) < half);
  const a = project({ x: at.piece.ax, y: at.piece.ay, z: at.piece.z }), b = project({ x: at.piece.bx, y: at.piece.by, z: at.piece.z });
  // The direction in which the line's places are spread.
  let xx = (a.x - b.x) ** 2 / 4, xy = (a.x - b.x) * (a.y - b.y) / 4, yy = (a.y - b.y) ** 2 / 4;
  for (const f of same) {
    xx += (f.x - at.x) ** 2;
    xy += (f.x - at.x) * (f.y - at.y);
    yy += (f.y - at.y) ** 2;
  }
  const angle = Math.atan2(2 * xy, xx - yy) / 2;
  const along = [Math.cos(angle), Math.sin(angle)];
  const shares = [...same, a, b].map((f) => (f.x - at.x) * along[0] + (f.y - at.y) * along[1]);
  const bend = same.reduce((worst, f) => Math.max(worst, Math.abs((f.y - at.y) * along[0] - (f.x - at.x) * along[1])), 0);
  if (bend > mostBend || Math.min(...shares) > -half / 2 || Math.max(...shares) < half / 2) return null;
  // Another index contour as near as this would run through the letters.
  const isCrowded = near.some((f) => f.piece.height !== at.piece.height &&
    Math.abs((f.y - at.y) * along[0] - (f.x - at.x) * along[1]) < 7);
  if (isCrowded) return null;
  const { piece } = at;
  const foot = project({ x: (piece.ax + piece.bx) / 2, y: (piece.ay + piece.by) / 2, z: piece.z });
  const length = Math.hypot(piece.upX, piece.upY) || 1, reach = Math.hypot(piece.bx - piece.ax, piece.by - piece.ay) || 1;
  const head = project({
    x: (piece.ax + piece.bx) / 2 + piece.upX / length * reach, y: (piece.ay + piece.by) / 2 + piece.upY / length * reach, z: piece.z,
  });
  // Letters stand on (sin, -cos) of their angle.
  const isUp = (head.x - foot.x) * along[1] - (head.y - foot.y) * along[0] >= 0;
  return {
    x: at.x, y: at.y, angle: isUp ? angle : angle + Math.PI, text: `${rounded(piece.height, 6)} ${sign}`, kind: 'contour',
    of: { x: (piece.ax + piece.bx) / 2, y: (piece.ay + piece.by) / 2, z: piece.z },
  };
}

/** Labels of peaks, the highest first. */
export function peakLabels(peaks: readonly Peak[], project: (place: Place) => Projected, sign: string): Label[] {
  return [...peaks].sort((a, b) => b.height - a.height).flatMap(({ place, height }): Label[] => {
    const at = project(place);
    return at.visible ? [{ x: at.x, y: at.y, angle: 0, text: `${height < 20 ? Math.round(10 * height) / 10 : Math.round(height)} ${sign}`, kind: 'peak', of: place }] : [];
  });
}

/** A part of the picture, by its middle and half of its sides, CSS pixels. */
export interface Box {
  x: number;
  y: number;
  w: number;
  h: number;
}

/** A label's letters, and the mark below those of a peak. */
function boxOf(label: Label): Box {
  const isPeak = label.kind === 'peak';
  const length = 7 * label.text.length + 8, height = isPeak ? 30 : 16;
  const cosine = Math.abs(Math.cos(label.angle)), sine = Math.abs(Math.sin(label.angle));
  return {
    x: label.x, y: isPeak ? label.y - 12 : label.y, w: (length * cosine + height * sine) / 2, h: (length * sine + height * cosine) / 2,
  };
}

/** Those that lie whole in the picture and overlap neither its panels nor one before them. */
export function apart(labels: readonly Label[], size: { width: number; height: number }, panels: readonly Box[]): Label[] {
  const taken = [...panels];
  return labels.filter((label) => {
    const { x, y, w, h } = boxOf(label);
    const isWhole = x >= w && y >= h && x <= size.width - w && y <= size.height - h;
    const isFree = isWhole && taken.every((t) => Math.abs(t.x - x) > t.w + w || Math.abs(t.y - y) > t.h + h);
    if (isFree) taken.push({ x, y, w, h });
    return isFree;
  });
}

const namespace = 'http://www.w3.org/2000/svg';

/** Writes labels into a drawing over the picture, anew. */
export function drawLabels(svg: Element, labels: readonly Label[]): void {
  svg.replaceChildren(...labels.flatMap(({ x, y, angle, text, kind }) => {
    const made = document.createElementNS(namespace, 'text');
    made.textContent = text;
    made.setAttribute('class', kind);
    const isPeak = kind === 'peak';
    made.setAttribute('transform', `translate(${x.toFixed(1)} ${(isPeak ? y - 14 : y).toFixed(1)}) rotate(${(angle * 180 / Math.PI).toFixed(1)})`);
    if (!isPeak) return [made];
    const mark = document.createElementNS(namespace, 'path');
    mark.setAttribute('d', `M${x.toFixed(1)} ${(y - 5).toFixed(1)}l4.5 7h-9z`);
    return [mark, made];
  }));
}
