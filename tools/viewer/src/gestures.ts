// SPDX-License-Identifier: GPL-3.0-or-later
//
// How pointers move the camera: a button or a finger drags the ground, the right button or two fingers go round what is below
// them, the wheel and two fingers come nearer to it. In a frame of another page the wheel alone, and a finger up or down, are
// that page's, which would else end where they meet the terrain.
import type { Triple } from './space';
import type { Point, View } from './view';

/** Degrees a pixel. */
const turnPerPixel = 0.28;
/** Pixels after which two fingers are understood. */
const understood = 10;

type Pixel = { x: number; y: number };

/** Whether the page is part of another one. */
export interface Framed {
  isFramed: boolean;
  /** The wheel went on to the other page; its user may not know how to come nearer. */
  passedOn(): void;
}

export class Gestures {
  private readonly pointers = new Map<number, Pixel>();
  private level = 0;
  private pivot: Triple = [0, 0, 0];
  private orbits = false;
  /** The gesture of two fingers; null until it is clear. */
  private pair: 'tilt' | 'pinch' | null = null;
  private begun: Pixel[] = [];

  constructor(private readonly canvas: HTMLCanvasElement, private readonly view: View, framed: Framed) {
    canvas.style.touchAction = framed.isFramed ? 'pan-y' : 'none';
    canvas.addEventListener('pointerdown', (e) => { this.down(e); });
    canvas.addEventListener('pointermove', (e) => { this.move(e); });
    for (const end of ['pointerup', 'pointercancel'] as const) canvas.addEventListener(end, (e) => { this.up(e); });
    canvas.addEventListener('contextmenu', (e) => { e.preventDefault(); });
    canvas.addEventListener('wheel', (e) => {
      if (framed.isFramed && !e.ctrlKey && !e.metaKey) {
        framed.passedOn();
        return;
      }
      e.preventDefault();
      const lines = e.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
      const step = Math.max(-240, Math.min(240, e.deltaY * lines));
      view.zoomAt(this.point({ x: e.clientX, y: e.clientY }), Math.exp(step * (e.ctrlKey ? 0.008 : 0.0016)));
    }, { passive: false });
  }

  private point({ x, y }: Pixel): Point {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return { x: 2 * (x - left) / width - 1, y: 1 - 2 * (y - top) / height };
  }

  private get centre(): Pixel {
    const all = [...this.pointers.values()];
    return { x: all.reduce((s, p) => s + p.x, 0) / all.length, y: all.reduce((s, p) => s + p.y, 0) / all.length };
  }

  private down(e: PointerEvent): void {
    if (e.pointerType === 'mouse' && this.pointers.size > 0) return;
    this.canvas.setPointerCapture?.(e.pointerId);
    this.pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    this.orbits = e.button === 2 || e.button === 1 || e.ctrlKey || e.shiftKey;
    this.begin();
  }

  /** The fingers that are down begin anew. */
  private begin(): void {
    const at = this.point(this.centre);
    this.pivot = this.view.pivotAt(at);
    this.level = this.pivot[2];
    this.pair = null;
    this.begun = [...this.pointers.values()];
  }

  private move(e: PointerEvent): void {
    const before = this.pointers.get(e.pointerId);
    if (before === undefined) return;
    const now = { x: e.clientX, y: e.clientY };
    const pair = [...this.pointers.values()];
    const centre = this.centre;
    this.pointers.set(e.pointerId, now);
    if (this.pointers.size === 2) {
      this.movePair(pair, centre);
    } else if (this.orbits) {
      this.view.orbit(this.pivot, (now.x - before.x) * turnPerPixel, (before.y - now.y) * turnPerPixel);
    } else {
      this.view.drag(this.point(before), this.point(now), this.level);
    }
  }

  private movePair(before: Pixel[], centre: Pixel): void {
    const now = [...this.pointers.values()];
    this.pair ??= this.understand(now);
    if (this.pair === null) return;
    const middle = this.centre;
    if (this.pair === 'tilt') {
      this.view.orbit(this.pivot, 0, (centre.y - middle.y) * turnPerPixel);
      return;
    }
    this.view.drag(this.point(centre), this.point(middle), this.level);
    const [was, is] = [apart(before), apart(now)];
    this.view.zoomAt(this.point(middle), was.length / Math.max(is.length, 1));
    // The ground turns with the fingers, so the camera turns against them.
    const turn = Math.atan2(Math.sin(is.angle - was.angle), Math.cos(is.angle - was.angle)) * 180 / Math.PI;
    this.view.orbit(this.view.pivotAt(this.point(middle)), -turn, 0);
  }

  /** Two fingers that go up or down together tilt. */
  private understand(now: Pixel[]): 'tilt' | 'pinch' | null {
    const [a, b] = now.map((p, i) => ({ x: p.x - this.begun[i].x, y: p.y - this.begun[i].y }));
    if (Math.max(Math.hypot(a.x, a.y), Math.hypot(b.x, b.y)) < understood) return null;
    const isTogether = a.y * b.y > 0 && Math.abs(a.y) > 2 * Math.abs(a.x) && Math.abs(b.y) > 2 * Math.abs(b.x);
    return isTogether ? 'tilt' : 'pinch';
  }

  private up(e: PointerEvent): void {
    if (!this.pointers.delete(e.pointerId)) return;
    if (this.pointers.size > 0) this.begin();
    else this.view.settle();
  }
}

function apart([a, b]: Pixel[]): { length: number; angle: number } {
  return { length: Math.hypot(b.x - a.x, b.y - a.y), angle: Math.atan2(b.y - a.y, b.x - a.x) };
}
