// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a line of sight and its first Fresnel zone are drawn, at a share of the way. The engine answers what they meet.
import type { Profile, Sight, SightRequest } from './answers';
import type { Frame } from './frame';
import { heightsOf } from './stations';

/** In the height's unit. */
export interface DrawnSight {
  at: (share: number) => number;
  /** 0 without a frequency. */
  radius: (share: number) => number;
}

/** The line sinks as the Earth below it bends: so it stands to the flat picture as it stands to the ground. */
export function drawnSight(answer: { request: SightRequest; sight: Sight; profile: Profile }, frame: Frame): DrawnSight {
  const { request, sight: { length }, profile } = answer;
  const { curvature, lightSpeed } = frame.earth;
  const known = heightsOf(profile.stations);
  const from = (known[0] ?? 0) + request.observerHeight / frame.scaleZ;
  const to = (known[known.length - 1] ?? 0) + request.targetHeight / frame.scaleZ;
  const wavelength = request.frequency > 0 ? lightSpeed / request.frequency : 0;
  return {
    at: (share) => from + share * (to - from) - curvature * length * length * share * (1 - share),
    radius: (share) => Math.sqrt(wavelength * length * share * (1 - share)),
  };
}
