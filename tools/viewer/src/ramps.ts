// SPDX-License-Identifier: GPL-3.0-or-later
//
// Colours by height and by slope, as textures and as gradients of the legend.

export type Stop = readonly [share: number, r: number, g: number, b: number];

/** Lowland greens over straw and ochre to rock and snow. */
export const heightStops: readonly Stop[] = [
  [0, 112, 150, 112], [0.1, 133, 168, 117], [0.22, 163, 186, 128], [0.36, 200, 203, 146], [0.5, 217, 198, 146],
  [0.63, 201, 169, 126], [0.76, 174, 144, 117], [0.87, 186, 173, 162], [0.95, 224, 221, 217], [1, 250, 250, 252],
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

/** The colours up to a share, spread over all of it. */
export function stopsUpTo(share: number, stops: readonly Stop[]): readonly Stop[] {
  const below = stops.filter(([at]) => at < share).map(([at, r, g, b]): Stop => [at / share, r, g, b]);
  return [...below, [1, ...colourAt(stops, share)]];
}

/** A row of pixels, red, green, blue and 255 each. */
export function rampPixels(stops: readonly Stop[]): Uint8Array {
  const width = 256;
  const pixels = new Uint8Array(4 * width);
  for (let i = 0; i < width; ++i) pixels.set([...colourAt(stops, i / (width - 1)), 255], 4 * i);
  return pixels;
}

export function gradientOf(stops: readonly Stop[]): string {
  return `linear-gradient(90deg, ${stops.map(([s, r, g, b]) => `rgb(${r} ${g} ${b}) ${100 * s}%`).join(', ')})`;
}
