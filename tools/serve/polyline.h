// SPDX-License-Identifier: GPL-3.0-or-later
//
// Google's encoded polylines: differences of latitude and longitude at 1e-5 degrees, five bits a
// character (developers.google.com/maps/documentation/utilities/polylinealgorithm).
#pragma once

#include <string_view>
#include <vector>

#include "engine/query/questions.h"

namespace ptin::serve {

/// @return Positions as longitude (x) and latitude (y).
/// @throws http::Problem 400  a character that no polyline has, or an end within a number
[[nodiscard]] std::vector<MapPoint> decode_polyline(std::string_view text);

}  // namespace ptin::serve
