// SPDX-License-Identifier: GPL-3.0-or-later
//
// The compass among the buttons: shows where north is, and turns there.
import { part } from './page';

const needle = 'M12 3l3.6 9H8.4z', tail = 'M12 21l-3.6-9h7.2z';

export class Compass {
  private readonly drawing: SVGSVGElement;

  constructor(pressed: () => void) {
    const button = document.createElement('button');
    button.id = 'compass';
    button.className = 'icon';
    button.title = 'North up (n)';
    button.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"><path class="north" d="${needle}"/><path class="south" d="${tail}"/></svg>` +
      '<span class="hidden">Turn until north is up</span>';
    button.addEventListener('click', pressed);
    this.drawing = button.querySelector('svg')!;
    part('home').before(button);
  }

  /** Degrees, and from straight down: the needle lies on the ground. */
  show(heading: number, tilt: number): void {
    this.drawing.style.transform = `rotateX(${Math.min(45, tilt)}deg) rotateZ(${-heading}deg)`;
  }
}
