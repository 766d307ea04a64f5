// SPDX-License-Identifier: GPL-3.0-or-later
//
// Regions and places that miss the terrain.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"

namespace ptin::tools {

/// Refuses a region that shares no point with the box of the terrain's samples: no answer could
/// hold anything of the terrain. A region within the box but outside of the terrain's hull passes.
/// @param option  Gave the region; named in the error.
/// @throws Error invalid_argument  states the terrain's bounds, and whether the region would meet
///                                 them if x and y changed places; as GridRegion
/// Cost: linear in the region's corners.
void check_on_terrain(const Region& region, const StoreFacts& facts, const std::string& option);

/// Why places miss the box of the terrain's samples, as the end of a sentence: its bounds, and whether
/// some would lie there with x and y exchanged, or taken as longitude and latitude. None where one
/// of them lies there, and where there are no places.
[[nodiscard]] std::optional<std::string> why_all_miss(std::span<const MapPoint> places,
                                                      const StoreFacts& facts, const CrsFacts& crs);

/// The window of four numbers.
/// @param option  Gave the numbers; named in errors.
/// @throws Error invalid_argument  a number is not finite, or the window is inverted
[[nodiscard]] Window window_of(const std::vector<double>& numbers, const std::string& option);

}  // namespace ptin::tools
