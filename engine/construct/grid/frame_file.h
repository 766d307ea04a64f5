// SPDX-License-Identifier: GPL-3.0-or-later
//
// The frame of a terrain in a temporary file.
#pragma once

#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// Appends `frame` to a file of arrays.  @throws Error io_error, resource_exhausted
void put_frame(ArrayFileWriter& file, const TerrainFrame& frame);
/// Reads the frame that put_frame() wrote at this place of the file.
/// @throws Error corruption  the next arrays are no frame, or are damaged
[[nodiscard]] TerrainFrame take_frame(ArrayFileReader& file);

}  // namespace ptin
