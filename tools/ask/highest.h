// SPDX-License-Identifier: GPL-3.0-or-later
//
// The question of the highest or lowest point: `ptin highest`, and `highest` over HTTP.
#pragma once

#include <vector>

#include "tools/ask/field.h"
#include "tools/ask/groups.h"

namespace ptin::ask {

struct HighestQuestion {
  HighestRequest request;
  RegionText region;
};
void add_highest(Parameters& rows, HighestQuestion& question);

struct HighestAnswer {
  const HighestResult* result;
  bool lowest = false;
};
[[nodiscard]] Fields<HighestAnswer> highest_fields();

/// The point, or one of the vertices, as a feature.
struct HighestPlace {
  HeightAt at;
  std::size_t rank = 1;
  bool at_vertex = true;
  const HighestResult* result = nullptr;  ///< Of the point; null: a further vertex.
};
[[nodiscard]] Fields<HighestPlace> highest_place_fields();
/// The point, then the other vertices; none where there is no surface.
[[nodiscard]] std::vector<HighestPlace> places_of(const HighestResult& result);

}  // namespace ptin::ask
