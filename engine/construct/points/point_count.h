// SPDX-License-Identifier: GPL-3.0-or-later
//
// How many points some inputs may hold, before they are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"

namespace ptin {

/// What is known of the points of some inputs before they are read.
struct PointCount {
  /// Points of all inputs, those that a choice leaves out included. The header of LAS says it; OGR
  /// says the features of a layer, or nothing, which counts as 0; text and TINs are estimated from
  /// how they begin (read/tin_count.h).
  std::uint64_t points = 0;
  std::vector<std::uint64_t> of_tins;  ///< Vertices of each, the largest first.
  bool is_known = true;      ///< false: an input is no file (a pipe), and can be read only once.
  bool may_be_less = false;  ///< Classes, returns, bounds or nodata may leave out any part.

  /// The most vertices of TINs that so many processes sort at once, of which each sorts one at a time.
  [[nodiscard]] std::uint64_t of_tins_at_once(std::size_t processes) const noexcept;
};

/// Looks at headers, and at the first points of text and TINs. Cost: opens each input.
/// @throws Error as open_point_stream()
[[nodiscard]] PointCount count_points(const std::vector<std::string>& inputs,
                                      const SourceOptions& options);

}  // namespace ptin
