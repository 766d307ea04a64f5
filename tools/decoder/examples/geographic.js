// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the terrain's CRS, which its stream tells as WKT, to longitudes and latitudes. proj4 knows no grid shifts: a datum other
// than WGS 84 may come out some metres off.
import proj4 from 'proj4';
import { toldBy } from 'ptin-decoder';

/** A function from map positions to [longitude, latitude]. */
export function toGeographic(decoder) {
  const { crs } = toldBy(decoder.metadata);
  if (crs === '') throw new Error('the stream does not tell its CRS, so it has no place on a map');
  return proj4(crs, 'WGS84').forward;
}

/** Metres of a height; heights whose unit is not known are taken for metres. */
export function metresPerHeight(decoder) {
  return toldBy(decoder.metadata).ground?.metres_per_height ?? 1;
}
