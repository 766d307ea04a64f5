// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the terrain's CRS, which its stream tells as WKT, to longitudes and latitudes. proj4 knows no grid shifts: a datum other
// than WGS 84 may come out some metres off.
import proj4 from 'proj4';

/** A function from map positions to [longitude, latitude]. */
export function toGeographic({ mapCrs }) {
  if (mapCrs === null) throw new Error('the terrain does not tell its CRS, so it has no place on a map');
  return proj4(mapCrs, 'WGS84').forward;
}
