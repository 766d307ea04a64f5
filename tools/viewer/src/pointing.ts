// SPDX-License-Identifier: GPL-3.0-or-later
//
// The place under the pointer, or under the cross-hair of the keys: its height is told where it rests, and a click asks about it.
import type { Certified } from 'ptin-decoder';
import { certifiedAt } from 'ptin-decoder/values';
import type { Frame } from './frame';
import type { Inquiry } from './inquiry';
import { part } from './page';
import type { Panel } from './panel';
import type { Relief } from './relief';

export interface Shown {
  frame: Frame;
  certified: Certified;
}

export class Pointing {
  private timer = 0;

  /** @param shown  What is shown; null: nothing yet. */
  constructor(
    private readonly relief: Relief, private readonly panel: Panel, private readonly inquiry: Inquiry,
    private readonly shown: () => Shown | null,
  ) {
    const { canvas } = relief;
    let pressed: { x: number; y: number } | null = null;
    canvas.addEventListener('pointerdown', (e) => {
      pressed = e.isPrimary && e.button === 0 ? { x: e.clientX, y: e.clientY } : null;
      canvas.classList.remove('ringed');
    });
    canvas.addEventListener('pointerup', (e) => {
      const isClick = pressed !== null && Math.hypot(e.clientX - pressed.x, e.clientY - pressed.y) < 5;
      pressed = null;
      part('crosshair').hidden = true;
      if (isClick) this.inquiry.click(this.relief.pick(e.clientX, e.clientY));
    });
    // A place is told where the pointer rests: numbers that run are not read.
    canvas.addEventListener('pointermove', (e) => {
      clearTimeout(this.timer);
      part('crosshair').hidden = true;
      if (e.pointerType === 'touch' || e.buttons !== 0) return;
      this.timer = window.setTimeout(() => { this.tellPlace(e.clientX, e.clientY); }, 160);
    });
    canvas.addEventListener('pointerleave', () => {
      clearTimeout(this.timer);
      this.panel.showPlace(null);
    });
    // A ring shows whom the keys belong to, when one came here by them; shortcuts work without it.
    canvas.addEventListener('focus', () => { canvas.classList.toggle('ringed', canvas.matches(':focus-visible')); });
    canvas.addEventListener('blur', () => { canvas.classList.remove('ringed'); });
  }

  private tellPlace(x: number, y: number): void {
    const shown = this.shown();
    if (shown === null) return;
    const { frame, certified } = shown;
    const place = this.relief.pick(x, y);
    if (place === null) {
      this.panel.showPlace({ where: '', height: null, slack: null });
      return;
    }
    const at = { x: frame.mapX(place.x), y: frame.mapY(place.y) };
    const certificate = certifiedAt(certified, [at]);
    this.panel.showPlace({
      where: frame.where(at), height: frame.heightAt(place.z), slack: certificate?.deviation ?? null,
    });
  }

  /** Puts the cross-hair of the keys into the middle, and tells what is there. */
  aim(): void {
    part('crosshair').hidden = false;
    clearTimeout(this.timer);
    const { clientWidth, clientHeight } = this.relief.canvas;
    this.timer = window.setTimeout(() => { this.tellPlace(clientWidth / 2, clientHeight / 2); }, 160);
  }

  /** Asks about the middle of the picture. */
  clickMiddle(): void {
    const { clientWidth, clientHeight } = this.relief.canvas;
    this.inquiry.click(this.relief.pick(clientWidth / 2, clientHeight / 2));
  }
}
