// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where north is on a map.
#pragma once

#include <optional>

#include "engine/crs/crs_facts.h"
#include "engine/geometry/affine.h"

namespace ptin::tools {

/// The direction of true north at a place of a plane whose y goes up: radians clockwise from up. 0 in a
/// geographic CRS; none where the CRS is unknown, or the place lies outside of what it can hold.
/// Cost: PROJ looks the CRS up, some milliseconds.
[[nodiscard]] std::optional<double> north_at(MapPoint place, const CrsFacts& crs);

}  // namespace ptin::tools
