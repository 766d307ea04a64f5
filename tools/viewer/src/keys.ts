// SPDX-License-Identifier: GPL-3.0-or-later
//
// The keys and what they do. The page's list of them (index.html) says the same.
import type { Inquiry } from './inquiry';
import { part } from './page';
import type { Panel } from './panel';
import type { Pointing } from './pointing';
import type { View } from './view';

export interface Keyed {
  canvas: HTMLCanvasElement;
  view: View;
  panel: Panel;
  inquiry: Inquiry;
  pointing: Pointing;
  isServed: boolean;
  isMapThere(): boolean;
  savePicture(): void;
  copyLink(): void;
  /** The picture or the link may be another. */
  moved(): void;
}

/** The action of each key, by its name or its letter. */
function actionsOf({ view, panel, inquiry, pointing, isServed, isMapThere, savePicture, copyLink }: Keyed): Record<string, () => void> {
  return {
    ArrowLeft: () => { view.pan(-1, 0); },
    ArrowRight: () => { view.pan(1, 0); },
    ArrowUp: () => { view.pan(0, 1); },
    ArrowDown: () => { view.pan(0, -1); },
    '+': () => { view.zoom(0.8); },
    '=': () => { view.zoom(0.8); },
    '-': () => { view.zoom(1.25); },
    PageUp: () => { view.tilt(-5); },
    PageDown: () => { view.tilt(5); },
    ',': () => { view.turn(-10); },
    '.': () => { view.turn(10); },
    r: () => { view.flyHome(); },
    n: () => { view.turnNorth(); },
    w: () => { panel.set('wireframe', !panel.settings.wireframe); },
    i: () => { panel.set('interval', panel.settings.interval > 0 ? 0 : panel.usualInterval); },
    1: () => { panel.set('shading', 'height'); },
    2: () => { panel.set('shading', 'slope'); },
    3: () => { panel.set('shading', 'shade'); },
    4: () => { if (isMapThere()) panel.set('shading', 'map'); },
    h: () => { inquiry.choose('height'); },
    p: () => { inquiry.choose('profile'); },
    s: () => { inquiry.choose('sight'); },
    v: () => { if (isServed) inquiry.choose('viewshed'); },
    a: () => { inquiry.choose('area'); },
    e: () => { savePicture(); },
    Backspace: () => { inquiry.back(); },
    l: () => { copyLink(); },
    '?': () => { part<HTMLDialogElement>('keys').showModal(); },
    Enter: () => { pointing.clickMiddle(); },
    Escape: () => { inquiry.close(); },
  };
}

/** Has keys work wherever on the page they are pressed, but for those that a field or a dialogue wants itself. */
export function followKeys(keyed: Keyed): void {
  const actions = actionsOf(keyed);
  addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || part<HTMLDialogElement>('keys').open) return;
    if (target.matches('input[type=number], input[type=text]') && event.key !== 'Escape') return;
    if (/^(Arrow|Page)/.test(event.key) && target.matches('input')) return;
    if (event.key === 'Enter' && target !== keyed.canvas) return;
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
    if (/^(Arrow|Enter|Page|Back)|^[-+=,.]$/.test(event.key)) keyed.pointing.aim();
    if (!['?', 'Enter', 'Escape', 'Backspace', 'e', 'l'].includes(event.key)) keyed.moved();
  });
}
