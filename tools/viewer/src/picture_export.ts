// SPDX-License-Identifier: GPL-3.0-or-later
//
// The picture as a file: the terrain as it is drawn, its labels, the scale, and whom to name.
import type { Label } from './labels';
import { colour } from './page';

export interface Caption {
  title: string;
  attribution: string;
  /** The length of the bar in CSS pixels, and what it says; null: no scale is known. */
  scale: { width: number; text: string } | null;
  labels: readonly Label[];
}

/** Saves the canvas. Must run behind a drawing, in the same frame: a browser forgets what WebGL drew before. */
export function savePicture(canvas: HTMLCanvasElement, caption: Caption): void {
  const made = document.createElement('canvas');
  made.width = canvas.width;
  made.height = canvas.height;
  const context = made.getContext('2d')!;
  const ratio = canvas.width / Math.max(1, canvas.clientWidth);
  const { clientWidth: width, clientHeight: height } = canvas;
  context.scale(ratio, ratio);
  const sky = context.createLinearGradient(0, 0, 0, height * 0.62);
  sky.addColorStop(0, colour('sky-top'));
  sky.addColorStop(1, colour('sky-low'));
  context.fillStyle = sky;
  context.fillRect(0, 0, width, height);
  context.drawImage(canvas, 0, 0, width, height);
  write(context, caption, width, height);
  made.toBlob((blob) => {
    if (blob === null) return;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = `${caption.title.replace(/[^\w.-]+/g, '_') || 'terrain'}.png`;
    link.click();
    setTimeout(() => { URL.revokeObjectURL(link.href); }, 10000);
  }, 'image/png');
}

function write(context: CanvasRenderingContext2D, caption: Caption, width: number, height: number): void {
  const { fontFamily } = getComputedStyle(document.body);
  Object.assign(context, { fillStyle: colour('ink'), strokeStyle: colour('halo'), lineJoin: 'round', lineWidth: 3, textBaseline: 'middle' });
  const text = (content: string, x: number, y: number, align: CanvasTextAlign, size: number): void => {
    context.font = `600 ${size}px ${fontFamily}`;
    context.textAlign = align;
    context.strokeText(content, x, y);
    context.fillText(content, x, y);
  };
  for (const { x, y, angle, text: content, kind } of caption.labels) {
    context.save();
    context.translate(x, kind === 'peak' ? y - 14 : y);
    context.rotate(angle);
    text(content, 0, 0, 'center', 11);
    context.restore();
  }
  text(caption.title, 14, height - (caption.attribution === '' ? 18 : 36), 'left', 15);
  text(caption.attribution, 14, height - 16, 'left', 11);
  if (caption.scale === null) return;
  const right = width - 16, left = right - caption.scale.width;
  text(caption.scale.text, (left + right) / 2, height - 16, 'center', 12);
  for (const style of ['halo', 'ink'] as const) {
    context.strokeStyle = colour(style);
    context.lineWidth = style === 'halo' ? 4 : 1.5;
    context.beginPath();
    context.moveTo(left, height - 33);
    context.lineTo(left, height - 27);
    context.lineTo(right, height - 27);
    context.lineTo(right, height - 33);
    context.stroke();
  }
}
