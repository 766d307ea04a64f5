// SPDX-License-Identifier: GPL-3.0-or-later
//
// Areas where nobody can be asked: of a file, and of a service that has no /volume.
import { Problem } from 'ptin-decoder';
import type { Frame } from './frame';
import type { Answer, QuestionOf } from './messages';

/** The area of a polygon in plan; of degrees, and of volumes, the page knows nothing. Throws a Problem where there is none. */
export function measuredInPlan(question: QuestionOf<'area'>, frame: Frame): Answer {
  const { unit, metres } = frame.earth.lengths;
  if (frame.isDegrees || metres === null) {
    throw new Problem('No areas', 'Areas in degrees, or in map units of an unknown size, need a service that has /volume.');
  }
  const { ring } = question;
  const [o] = ring;
  const twice = ring.reduce((sum, a, i) => {
    const b = ring[(i + 1) % ring.length];
    return sum + (a.x - o.x) * (b.y - o.y) - (b.x - o.x) * (a.y - o.y);
  }, 0);
  return {
    ...question, measured: { surface: Math.abs(twice) / 2, empty: 0, cut: null, fill: null, unit },
    certainty: { error: null, deviation: null, of: 'mesh', isExact: true },
  };
}
