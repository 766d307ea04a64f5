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
  std::string crs;             ///< The CRS that all files declare; "" where a_srs replaces it.
  std::string vertical_crs;    ///< Likewise; "" also where options.vertical_crs replaces it.
  DeclaredUnits units;         ///< Those of all files.
  double largest_shift = 0.0;  ///< The largest PointStream::largest_shift(), CRS units.
  std::uint64_t points = 0;
  std::uint64_t left_out = 0;
};

/// Hands every wanted point to `take`, file after file.
/// @param progress  Receives the progress in the file at hand (PointStream::done()); may be empty.
/// @param memory    As StreamResources::memory.
/// @throws Error as PointBuckets::read(), and what `take` throws
[[nodiscard]] PointReading read_sources(
    const std::vector<std::string>& paths, const SourceOptions& options,
    const std::function<void(const SourcePoint&)>& take, const std::stop_token& stop,
    const std::function<void(std::uint64_t done, std::uint64_t total)>& progress,
    const ExternalMemory* memory = nullptr);

}  // namespace ptin
