// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a straight line and a triangle share, told from the triangle alone.
#pragma once

#include <optional>

#include "engine/query/living/living_triangle.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// The points of a line that a closed triangle holds: a stretch, or a single point.
struct SharedStretch {
  LinePoint from, to;
  bool along_edge = false;  ///< The stretch lies on a side, so that a neighbour may hold it too.
  bool is_point = false;    ///< `from` and `to` are one point.
};

/// What the triangle holds of the line from p to q; none when they share no point. Exact: a point
/// is the mean of the same codes, by the same weights, as LineWalk has it in either triangle beside
/// it. Only where an end of the line lies on an edge are the weights those of this triangle.
/// REQUIRES: p != q.
[[nodiscard]] std::optional<SharedStretch> shared_stretch(const LivingTriangle& t,
                                                          const HeightEncoding& heights, Spot p,
                                                          Spot q);

}  // namespace ptin
