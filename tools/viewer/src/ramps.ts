// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colours by height and by slope, as textures and as gradients of the legend.
import { DataTexture, LinearFilter, RGBAFormat } from 'three';

type Stop = readonly [share: number, r: number, g: number, b: number];

/** Lowland greens over straw and ochre to rock and snow. */
export const heightStops: readonly Stop[] = [
  [0, 66, 112, 94], [0.08, 92, 138, 102], [0.2, 140, 168, 112], [0.34, 193, 194, 134], [0.48, 214, 189, 133],
  [0.62, 190, 150, 106], [0.76, 154, 120, 97], [0.87, 171, 158, 149], [0.95, 218, 216, 214], [1, 248, 249, 251],
];

/** From flat to 60 degrees. */
export const slopeStops: readonly Stop[] = [
  [0, 236, 240, 236], [0.16, 188, 214, 186], [0.33, 235, 213, 128], [0.5, 233, 156, 84], [0.66, 204, 82, 62],
  [0.83, 133, 36, 74], [1, 58, 12, 56],
];

function colourAt(stops: readonly Stop[], share: number): [number, number, number] {
  const next = Math.max(1, stops.findIndex((stop) => stop[0] >= share));
  const [a, b] = [stops[next - 1], stops[next]];
  const part = (share - a[0]) / (b[0] - a[0]);
  return [1, 2, 3].map((i) => a[i] + part * (b[i] - a[i])) as [number, number, number];
}

export function rampTexture(stops: readonly Stop[]): DataTexture {
  const width = 256;
  const pixels = new Uint8Array(4 * width);
  for (let i = 0; i < width; ++i) pixels.set([...colourAt(stops, i / (width - 1)), 255], 4 * i);
  const texture = new DataTexture(pixels, width, 1, RGBAFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export function gradientOf(stops: readonly Stop[]): string {
  return `linear-gradient(90deg, ${stops.map(([s, r, g, b]) => `rgb(${r} ${g} ${b}) ${100 * s}%`).join(', ')})`;
}
