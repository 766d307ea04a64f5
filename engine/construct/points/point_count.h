// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many points there may be, before they are read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"

namespace ptin {

struct PointCount {
  std::uint64_t points = 0;          ///< At most, or nearly so: text is counted by its first lines.
  std::uint64_t of_largest_tin = 0;  ///< Vertices: TINs are sorted one at a time.
  bool is_known = true;      ///< false: an input is no file (a pipe), and can be read only once.
  bool may_be_less = false;  ///< Classes, bounds or nodata may leave out any part of them.
};

/// Looks at headers, and at the first points of text. Cost: opens each input.
/// @throws Error as open_point_stream()
[[nodiscard]] PointCount count_points(const std::vector<std::string>& inputs,
                                      const SourceOptions& options);

}  // namespace ptin
