// SPDX-License-Identifier: GPL-3.0-or-later
//
// The card with settings and facts: reads and writes Settings, shows Status.
import type { Certificate } from 'ptin-decoder';
import { bound, bytes, count, height as heightText, number, roundBelow, rounded, signOf } from './format';
import type { Frame } from './frame';
import type { Status } from './messages';
import { input, part } from './page';
import type { Settings } from './permalink';
import { gradientOf, heightStops, slopeStops } from './ramps';
import type { Relief, Shading } from './relief';

/** Errors that the slider tells apart: from a quarter of the relief down by this factor, then none. */
const errorSpan = 1e4;
const previewNote = 'a preview, not certified';

export class Panel {
  private frame: Frame | null = null;
  private timer = 0;
  private coloured: Relief['colours'] = null;
  private attribution = '';
  private isPreview = false;
  private mapCredit = '';

  /** @param changed is told which settings the user changed; errors only once the slider rests. */
  constructor(readonly settings: Settings, private readonly changed: (key: keyof Settings) => void) {
    for (const radio of document.querySelectorAll<HTMLInputElement>('input[name=shading]')) {
      radio.addEventListener('change', () => { this.set('shading', radio.value as Shading); });
    }
    for (const key of ['exaggeration', 'azimuth', 'altitude'] as const) {
      input(key).addEventListener('input', () => { this.set(key, Number(input(key).value)); });
    }
    input('interval').addEventListener('input', () => { this.set('interval', Math.max(0, Number(input('interval').value) || 0)); });
    input('wireframe').addEventListener('change', () => { this.set('wireframe', input('wireframe').checked); });
    input('error').addEventListener('input', () => {
      this.settings.error = this.errorAt(Number(input('error').value));
      this.show();
      clearTimeout(this.timer);
      this.timer = window.setTimeout(() => { this.changed('error'); }, 180);
    });
    this.show();
  }

  set<K extends keyof Settings>(key: K, value: Settings[K]): void {
    this.settings[key] = value;
    this.show();
    this.changed(key);
  }

  /** @param attribution  The attribution; empty: nobody told. */
  setFrame(frame: Frame, name: string, subtitle: string, attribution: string): void {
    this.frame = frame;
    this.attribution = attribution;
    this.showCredit();
    part('title').textContent = name;
    document.title = name;
    part('subtitle').textContent = subtitle;
    this.show();
  }

  /** At the lower edge: whom to name. Of a preview also that it is one, where there is no card, and in pictures that are saved. */
  private showCredit(): void {
    part('attribution').textContent = [this.attribution, this.mapCredit, this.isPreview ? previewNote : ''].filter(Boolean).join(' \u00b7 ');
  }

  /** Offers a base map. @param why  It cannot be shown; empty: it can. */
  offerMap(why: string): void {
    part('map-choice').hidden = false;
    document.querySelector<HTMLInputElement>('input[value=map]')!.disabled = why !== '';
    this.showMap('', why);
  }

  /** @param credit  Whom to name for a base map. @param note  What is wrong with it. Empty: nothing. */
  showMap(credit: string, note: string): void {
    this.mapCredit = credit === '' ? '' : `Map: ${credit}`;
    this.showCredit();
    part('map-note').hidden = note === '';
    part('map-note').textContent = note;
  }

  setColours(colours: Relief['colours']): void {
    this.coloured = colours;
    this.showLegend();
  }

  /** An interval that gives the relief some twenty lines. */
  get usualInterval(): number {
    return roundBelow(Math.max(this.relief, 1e-3) / 20);
  }

  /** Where the pointer or the cross-hair is, with the height there as far as the mesh is certified; null: nowhere. */
  showPlace(place: { where: string; height: number | null; slack: number | null } | null): void {
    if (place === null) {
      part('place').textContent = '';
      return;
    }
    const { where, height, slack } = place;
    // A height that nobody vouches for is told without digits that it may not have.
    const step = roundBelow(this.relief / 100);
    const told = document.createElement('b');
    told.textContent = height === null ? 'No terrain here'
      : slack === null ? `about ${heightText(Math.round(height / step) * step, 10 * step, this.sign)}`
      : heightText(height, slack, this.sign) + (slack > 0 ? ` \u00b1 ${bound(slack, 2)} ${this.sign}` : '');
    part('place').replaceChildren(told, where);
  }

  /** @param certificate  Of all that is in sight, or `everywhere`; null where nothing is known of a part of it. */
  showStatus(status: Status, certificate: Certificate | null, everywhere: boolean): void {
    const { sign } = this;
    const isExact = certificate?.error === 0 && certificate.deviation === 0;
    this.isPreview = status.isPreview === true;
    this.showCredit();
    part('certified').textContent = isExact ? 'Exact' : certificate === null ? '\u2013' : `\u00b1${bound(certificate.error)} ${sign}`;
    const where = everywhere ? 'at every sample' : 'at every sample in sight';
    // Clicks tell the same: what a mesh is off between the samples, where there is no other bound.
    const isWider = certificate !== null && certificate.deviation > certificate.error;
    const between = isWider ? `, \u00b1${bound(certificate.deviation)} ${sign} between` : '';
    const whole = certificate === null ? 'not certified in all that is in sight' : `certified ${where}${between}`;
    const waits = status.waitsFor === undefined ? 'still refining' : `waiting: ${status.waitsFor}`;
    part('certified-what').textContent = {
      loading: this.isPreview ? `${previewNote}; the terrain is on its way` : isExact ? waits : `${whole}, and ${waits}`,
      complete: isExact ? 'every sample is met' : whole,
      held: status.heldBy === 'error' ? whole + (certificate === null ? '' : ', as asked for')
        : `${whole}; more would be too much for this ${status.heldBy === 'service' ? 'service' : 'device'}`,
      cut: `${whole}; the rest of the stream did not arrive`,
      damaged: `${whole}; the rest of the stream is damaged`,
    }[status.state];
    part('fact-vertices').textContent = count(status.vertices);
    part('fact-triangles').textContent = count(status.triangles);
    part('fact-bytes').textContent = bytes(status.bytes) +
      (status.bytesInAll > status.bytes ? ` of ${bytes(status.bytesInAll)}` : '');
    part('fact-cost-row').hidden = status.cost === undefined || status.cost === '';
    part('fact-cost').textContent = status.cost ?? '';
    this.showProgress(status);
  }

  private showProgress(status: Status): void {
    const bar = part('progress');
    const share = status.state !== 'loading' ? 1
      : status.bytesInAll > 0 ? status.bytes / status.bytesInAll
      : status.splitsInAll > 0 ? status.splits / status.splitsInAll : 0.1;
    bar.querySelector<HTMLElement>('i')!.style.width = `${100 * share}%`;
    bar.setAttribute('aria-valuenow', String(Math.round(100 * share)));
    bar.classList.toggle('done', status.state !== 'loading');
  }

  private get relief(): number {
    return this.frame === null ? 1 : Math.max(this.frame.facts.maxHeight - this.frame.facts.minHeight, 1e-6);
  }
  private get sign(): string { return signOf(this.frame?.units.height ?? 'metre'); }

  private errorAt(place: number): number {
    if (place >= 100) return 0;
    return rounded(this.relief / 4 * errorSpan ** (-place / 99), 2);
  }
  private placeOf(error: number): number {
    if (error === 0) return 100;
    return Math.max(0, Math.min(99, Math.round(99 * Math.log(this.relief / 4 / error) / Math.log(errorSpan))));
  }

  private show(): void {
    const { settings: s, sign } = this;
    document.querySelector<HTMLInputElement>(`input[name=shading][value=${s.shading}]`)!.checked = true;
    for (const key of ['exaggeration', 'azimuth', 'altitude'] as const) {
      if (Number(input(key).value) !== s[key]) input(key).value = String(s[key]);
    }
    part('exaggeration-told').textContent = `${Number((s.exaggeration || 1).toFixed(1))}\u00d7`;
    part('azimuth-told').textContent = `${Math.round(s.azimuth)}\u00b0`;
    part('altitude-told').textContent = `${Math.round(s.altitude)}\u00b0`;
    part('error-told').textContent = s.error === 0 ? 'all' : `to \u00b1${number(s.error, 2)} ${sign}`;
    if (this.frame !== null) input('error').value = String(this.placeOf(s.error));
    input('wireframe').checked = s.wireframe;
    if (document.activeElement !== input('interval')) input('interval').value = s.interval === 0 ? '' : String(s.interval);
    part('interval-unit').textContent = sign;
    this.showLegend();
  }

  private showLegend(): void {
    const { shading } = this.settings;
    part('legend').hidden = shading === 'shade' || shading === 'map' || this.frame === null;
    const bar = part('legend').querySelector<HTMLElement>('i')!;
    bar.style.background = gradientOf(shading === 'slope' ? slopeStops : this.coloured?.stops ?? heightStops);
    if (this.frame === null) return;
    const { minHeight, maxHeight } = this.frame.facts;
    const [low, high] = this.coloured?.heights ?? [minHeight, maxHeight];
    const told = shading === 'slope' ? ['0\u00b0', '30\u00b0', '60\u00b0']
      : [low, (low + high) / 2, high].map((h) => `${number(h, h > 999 ? 4 : 3)} ${this.sign}`);
    ['low', 'middle', 'high'].forEach((at, i) => { part(`legend-${at}`).textContent = told[i]; });
  }
}
