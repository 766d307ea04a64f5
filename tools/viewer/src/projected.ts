// SPDX-License-Identifier: GPL-3.0-or-later
//
// A place of the scene in the picture.

export interface Projected {
  /** CSS pixels from the upper left of the picture. */
  x: number;
  y: number;
  /** It is before the camera and within the picture; something may hide it. */
  visible: boolean;
}
