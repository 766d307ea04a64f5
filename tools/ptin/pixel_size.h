// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels of rasters to write: those that --pixel-size asks for, and those of the raster that a
// terrain was built from.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "storage/store_file.h"
#include "tools/facts/quantity.h"

namespace ptin::tools {

/// The sides that --pixel-size names: each a number in map units, or with m, km or ft behind it a
/// length over ground.
/// @throws Error invalid_argument  no number > 0, another unit
[[nodiscard]] std::vector<Length> pixel_sides_of(const std::vector<std::string>& texts);

/// Width and height in map units of pixels with these sides; one side is both.
/// @param at  Where lengths over ground are turned into map units. In a geographic CRS a degree
///            differs elsewhere.
/// @throws Error invalid_argument  a length over ground, and the map unit is unknown
[[nodiscard]] std::array<double, 2> pixel_size_of(const std::vector<Length>& sides,
                                                  const CrsFacts& crs, MapPoint at);

/// The middle of the window, or where there is none of the box of the terrain's samples.
[[nodiscard]] MapPoint middle_of(const std::optional<Window>& window, const StoreFacts& facts);

/// Width and height of the pixels of the raster that a terrain was built from, in map units: the
/// steps of the grid.
/// @throws Error invalid_argument  samples do not fill the grid, so the terrain was built from
///                                 points or a TIN; asks for --pixel-size
/// @throws Error corruption  the counts in the metadata are no counts
[[nodiscard]] std::array<double, 2> own_pixel_size(const StoreFile& store);

}  // namespace ptin::tools
