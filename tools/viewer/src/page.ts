// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of the page by their ids, and what the page says.

export function part<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`the page has no part ${id}`);
  return found as T;
}

export function input(id: string): HTMLInputElement {
  return part<HTMLInputElement>(id);
}

/** The colour that the style sheet gives a name. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Hides parts of the page or shows them: drawings, too, which have no property for it. */
export function hide(isHidden: boolean, ...ids: string[]): void {
  for (const id of ids) part(id).toggleAttribute('hidden', isHidden);
}

let toastTimer = 0;
/** Says something for a moment. */
export function toast(text: string): void {
  const t = part('toast');
  t.textContent = text;
  t.classList.add('shown');
  clearTimeout(toastTimer);
  toastTimer = window.setTimeout(() => { t.classList.remove('shown'); }, 2600);
}

/** For screen readers alone. */
export function speak(text: string): void {
  part('spoken').textContent = text;
}

export function download(name: string, text: string, type: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => { URL.revokeObjectURL(link.href); }, 10000);
}
