// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights at the centres of pixels that stand on no lattice of the map: those of another projection.
#pragma once

#include <span>

#include "engine/geometry/affine.h"
#include "engine/query/heights/locate.h"
#include "engine/query/raster/raster.h"

namespace ptin {

/// The height of each centre is that which locate() gives for it, bit for bit, whatever is asked
/// together; NaN where it lies on no surface. A centre whose coordinates are not finite, as where a
/// projection knows no place, lies outside.
/// @param centres  Map units, close together: what lies between them is read.
/// REQUIRES: as many heights as centres.
/// @throws Error invalid_argument    as Detail
///               resource_exhausted  the centres do not fit the memory, at 48 bytes each
///               corruption, io_error, cancelled
/// Cost: the pages of the TIN in the box around the centres, and some 100 ns a centre; where these
/// are few for the TIN's vertices, that of locate().
RasterResult heights_at(const OpenedTerrain& terrain, std::span<const MapPoint> centres,
                        const LocateRequest& request, std::span<double> heights);

}  // namespace ptin
