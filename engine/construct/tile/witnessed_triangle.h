// SPDX-License-Identifier: GPL-3.0-or-later
//
// A triangle of the full TIN with its witness, and what an edge moves that crosses it.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "engine/construct/tile/border_witnesses.h"
#include "engine/construct/tile/ground_place.h"

namespace ptin {

/// One triangle of the full TIN, as border edges see that cross it.
struct WitnessedTriangle {
  static constexpr int kCornerWitness = 3;
  std::array<GridPoint, 3> corners;
  std::array<GridPoint, 3> nearest;  ///< The nearest known border vertex of each corner.
  std::array<bool, 3>
      is_border_side{};  ///< Side i, opposite to corner i, is or may be of the border.
  std::array<bool, 3> is_known_side{};  ///< Side i is of the border.
  double gap = 0.0;  ///< Distance of the regions of the other class that it lies between; else 0.
  int witness = kCornerWitness;  ///< The corner that is its witness; or there is a CornerWitness.
  float reach = std::numeric_limits<float>::infinity();  ///< Reach of that corner.
};

/// The triangle `t` of a part, with its witness.
[[nodiscard]] WitnessedTriangle witnessed_triangle(const PartOfTerrain& part,
                                                   const BorderWitnesses& witnesses, TriangleId t);

/// The greatest depth, in ground units, of a point of `piece`, the corners of a convex part of the
/// triangle: by the best of what its corners know. An upper bound.
[[nodiscard]] double greatest_depth(const WitnessedTriangle& triangle,
                                    std::span<const GroundPlace> piece, GroundStep step);

/// How far the border moves, in ground units, where a new border edge from a to b crosses the inside
/// of a triangle: the greatest depth in the piece that it cuts off from the witness, and the greatest
/// distance to it from the border in that piece. An upper bound.
[[nodiscard]] double border_crossing(const WitnessedTriangle& triangle, GridPoint a, GridPoint b,
                                     GroundStep step) noexcept;

}  // namespace ptin
