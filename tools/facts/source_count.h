// SPDX-License-Identifier: GPL-3.0-or-later
//
// Counts that the build made of its source, and what follows from them.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/query/questions.h"

namespace ptin::tools {

/// A count of the metadata's `source`, as "void_samples"; 0 when the build wrote none.
/// @throws Error corruption  what stands there is no count
[[nodiscard]] std::uint64_t source_count(const StoreFile& store, const char* key);

/// Width and height of the pixels of the raster that a terrain was built from, in map units: the
/// steps of the grid. None where samples do not fill the grid, so that it was built from points or a
/// TIN.
/// @throws Error as source_count()
[[nodiscard]] std::optional<MapPoint> own_pixel_of(const StoreFile& store);

}  // namespace ptin::tools
