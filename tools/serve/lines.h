// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights along lines, for the questions `trajectory` and `profile`.
#pragma once

#include <string>
#include <vector>

#include "engine/query/questions.h"
#include "tools/serve/answer_parts.h"

namespace ptin::serve {

/// A profile, and its positions as the client wants them.
struct AlongLines {
  ProfileResult profile;
  std::vector<MapPoint> client;  ///< For each point of the profile.
  std::string length_unit;       ///< Of distances: that of the map, in degrees metres.
  /// How far a side, straight in the client's CRS, is from the line that was walked; map units, 0
  /// where nothing was transformed.
  double bent_at_most = 0.0;
};

/// Reads `coords`, `crs`, `stations`, `error` and `vertices`, and walks the lines.
/// @throws http::Problem 400  no line has a length
///                       413  more positions than a question may name; more stations or points of
///                            the profile than an answer may have
[[nodiscard]] AlongLines walk_lines(const Asked& asked, const Places& places);

}  // namespace ptin::serve
