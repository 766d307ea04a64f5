// SPDX-License-Identifier: GPL-3.0-or-later
//
// A viewshed in colours that no relief has: the service's are greens and greys.

/** Opacity, red, green, blue of what is seen, too close to call, and not seen; the style sheet's legend has the same. */
const colours = { seen: [224, 32, 154, 165], perhaps: [244, 176, 224, 165], unseen: [42, 31, 69, 120] } as const;

/** The class of a pixel of the service's picture; null where nothing was asked. */
export function classOf(red: number, green: number, opacity: number): keyof typeof colours | null {
  if (opacity === 0) return null;
  if (red > 150) return 'perhaps';
  if (green > 120) return 'seen';
  return red > 80 ? 'perhaps' : 'unseen';
}

export async function recoloured(picture: Blob): Promise<ImageBitmap> {
  const given = await createImageBitmap(picture, { premultiplyAlpha: 'none' });
  const canvas = new OffscreenCanvas(given.width, given.height);
  const context = canvas.getContext('2d', { willReadFrequently: true })!;
  context.drawImage(given, 0, 0);
  const pixels = context.getImageData(0, 0, given.width, given.height);
  for (let i = 0; i < pixels.data.length; i += 4) {
    const found = classOf(pixels.data[i], pixels.data[i + 1], pixels.data[i + 3]);
    if (found !== null) pixels.data.set(colours[found], i);
  }
  context.putImageData(pixels, 0, 0);
  return createImageBitmap(canvas);
}
