// SPDX-License-Identifier: GPL-3.0-or-later
//
// The place under the pointer, or under the cross-hair of the keys: its height is told where it rests, and a click asks about it.
// The height of the picture comes at once, with what is certified of all places between samples, which where there are voids may
// be a hundred times what it is here; the service's own, of this place, comes where the pointer stays.
import type { Certified, MapPosition } from 'ptin-decoder';
import { certifiedAt } from 'ptin-decoder/values';
import type { Frame } from './frame';
import type { Inquiry } from './inquiry';
import { part } from './page';
import type { Panel } from './panel';
import type { Relief } from './relief';
import type { Service } from './service';

export interface Shown {
  frame: Frame;
  certified: Certified;
}

/** Milliseconds that the pointer rests before its place is told, and after that before the service is asked about it. */
const restsAfter = 160, staysAfter = 300;

export class Pointing {
  private timer = 0;
  /** The place of the picture that is pointed at; null: none. */
  private at: { x: number; y: number } | null = null;
  /** The number of places that were told, and ended: an answer about an earlier one comes too late. */
  private told = 0;

  /** @param shown  What is shown; null: nothing yet. @param service  Null: there is none. */
  constructor(
    private readonly relief: Relief, private readonly panel: Panel, private readonly inquiry: Inquiry,
    private readonly shown: () => Shown | null, private readonly service: Service | null,
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
      this.leave();
      part('crosshair').hidden = true;
      if (e.pointerType !== 'touch' && e.buttons === 0) this.pointAt(e.clientX, e.clientY);
    });
    canvas.addEventListener('pointerleave', () => {
      this.leave();
      this.panel.showPlace(null);
    });
    // A ring shows whom the keys belong to, when one came here by them; shortcuts work without it.
    canvas.addEventListener('focus', () => { canvas.classList.toggle('ringed', canvas.matches(':focus-visible')); });
    canvas.addEventListener('blur', () => { canvas.classList.remove('ringed'); });
  }

  /** The place is no longer pointed at. */
  private leave(): void {
    clearTimeout(this.timer);
    this.at = null;
    ++this.told;
  }

  private pointAt(x: number, y: number): void {
    this.leave();
    this.at = { x, y };
    this.timer = window.setTimeout(() => { this.tellPlace(x, y); }, restsAfter);
  }

  /** The camera moves: another place is pointed at. */
  moved(): void {
    if (this.at !== null) this.pointAt(this.at.x, this.at.y);
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
    const { service } = this;
    if (service === null || certificate?.deviation === 0) return;
    this.timer = window.setTimeout(() => { void this.askAbout(service, frame, at); }, staysAfter);
  }

  /** Tells a place's height as the full terrain has it. Where the service does not answer, that of the picture stays. */
  private async askAbout(service: Service, frame: Frame, at: MapPosition): Promise<void> {
    const told = ++this.told;
    const answer = await service.answer({ kind: 'height', at }, frame).catch(() => null);
    if (told !== this.told || answer?.kind !== 'height') return;
    const { height, least, most } = answer.located;
    // An interval that nobody certifies is none.
    const slack = height === null || least === null || most === null ? null : Math.max(height - least, most - height);
    if (slack !== null || height === null) this.panel.showPlace({ where: frame.where(at), height, slack });
  }

  /** Puts the cross-hair of the keys into the middle, and tells what is there. */
  aim(): void {
    part('crosshair').hidden = false;
    const { clientWidth, clientHeight } = this.relief.canvas;
    this.pointAt(clientWidth / 2, clientHeight / 2);
  }

  /** Asks about the middle of the picture. */
  clickMiddle(): void {
    const { clientWidth, clientHeight } = this.relief.canvas;
    this.inquiry.click(this.relief.pick(clientWidth / 2, clientHeight / 2));
  }
}
