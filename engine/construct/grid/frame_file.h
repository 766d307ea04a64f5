// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frame of a terrain in a temporary file.
#pragma once

#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

template <class File, MaybeConst<TerrainFrame> Frame>
void serialize(File& file, Frame& f) {
  file.values(f.map, f.heights.type, f.heights.step, f.heights.offset, f.height_rounding,
              f.height_quantum, f.min_height, f.max_height, f.vertical_crs_known, f.geographic,
              f.crs_wkt, f.horizontal_unit, f.vertical_unit);
}

}  // namespace ptin
