// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a line of sight and its Fresnel zone are drawn. The engine answers what they meet.

/** Curvature as the engine has it: 1 less 1/7 for refraction. */
const coefficient = 0.85714;
const speedOfLight = 299792458;

/** How far the straight line hangs above the curved Earth's chord at a share of its way: negative in between. In one unit. */
export function curvatureDrop(length: number, share: number, earthDiameter: number): number {
  return earthDiameter > 0 ? coefficient / earthDiameter * length * length * share * (share - 1) : 0;
}

/** The radius in metres. */
export function fresnelRadius(frequency: number, length: number, share: number): number {
  return Math.sqrt(Math.max(0, (speedOfLight / frequency) * length * share * (1 - share)));
}
