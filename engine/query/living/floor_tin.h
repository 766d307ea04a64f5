// SPDX-License-Identifier: GPL-3.0-or-later
//
// The full TIN of a raster in a box, as a mesh.
#pragma once

#include <functional>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/select/accounting.h"
#include "storage/floor.h"

namespace ptin {

/// The cells of a raster that meet a box, triangulated as the full TIN of the file is; the cells next to
/// the box where it lies beside the raster. Vertices are in the order of their keys.
/// @param wants  Whether a tile in a box is wanted; what is not is a void, and not read.
/// REQUIRES: the raster has a cell.
/// @throws Error resource_exhausted, corruption, io_error, cancelled
/// Cost: the tiles of the box, and 30 ns a sample. Memory: 72 bytes a sample, admitted.
[[nodiscard]] Tin floor_tin(const Floor& floor, const HeightEncoding& heights, const GridBox& box,
                            const std::function<bool(const GridBox&)>& wants,
                            QueryContext& context);

}  // namespace ptin
