// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading all files of a source of points, once.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/point_grid.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/terrain_frame.h"

namespace ptin {

struct ExternalMemory;

/// What is known when the last point has been read.
struct PointReading {
  PointGrid grid;
  std::string crs;             ///< As all files declare it; "" with options.a_srs.
  std::string vertical_crs;    ///< Likewise; "" with options.vertical_crs, too.
  double largest_shift = 0.0;  ///< That the sources made themselves, CRS units.
  std::uint64_t points = 0;
  std::uint64_t left_out = 0;
};

/// Hands every wanted point to `take`, file after file.
/// @param memory  For what is sorted before it is handed out (StreamResources).
/// @throws Error as PointBuckets::read(), and what `take` throws
[[nodiscard]] PointReading read_sources(
    const std::vector<std::string>& paths, const SourceOptions& options,
    const std::function<void(const SourcePoint&)>& take, const std::stop_token& stop,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress,
    const ExternalMemory* memory = nullptr);

}  // namespace ptin
