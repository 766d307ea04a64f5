// SPDX-License-Identifier: GPL-3.0-or-later
//
// The place of a spot in one triangle, told from the triangle alone.
#pragma once

#include <array>
#include <cstdint>

#include "engine/query/living/living_triangle.h"
#include "engine/query/walk/walk.h"

namespace ptin {

/// Twice the areas of the triangles of q and the side opposite to each corner.
[[nodiscard]] std::array<Int128, 3> weights_of(const LivingTriangle& t, Spot q);

/// The same of one triangle at many spots of its box: quicker where its sides are short. Threads:
/// immutable.
class SpotWeights {
 public:
  /// @param t  Borrowed.
  explicit SpotWeights(const LivingTriangle& t) noexcept : t_(t) {
    // Sides of 2^18 grid units make products of 2^58, which 64 bits hold.
    constexpr std::int32_t kShort = 1 << 18;
    const GridBox box = box_of(t);
    has_short_sides_ = box.max_x - box.min_x <= kShort && box.max_y - box.min_y <= kShort;
  }
  /// @param q  In the triangle's box.
  [[nodiscard]] std::array<Int128, 3> at(Spot q) const {
    if (!has_short_sides_) return weights_of(t_, q);
    const auto weight = [q](GridPoint a, GridPoint b) {
      const Spot from = spot_of(a);
      return Int128{(std::int64_t{b.x} - a.x) * (q.y - from.y) -
                    (std::int64_t{b.y} - a.y) * (q.x - from.x)};
    };
    return {weight(t_.corner[1].position, t_.corner[2].position),
            weight(t_.corner[2].position, t_.corner[0].position),
            weight(t_.corner[0].position, t_.corner[1].position)};
  }
  /// Whether the closed triangle holds a spot of these weights.
  [[nodiscard]] static bool is_inside(const std::array<Int128, 3>& weights) noexcept {
    return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
  }

 private:
  const LivingTriangle& t_;
  bool has_short_sides_;
};

/// The code of the height of a surface triangle at a spot that it holds, the same from both sides
/// of an edge, as the mean of the codes of its corners (walk/walk.h).
[[nodiscard]] WeightedCodes codes_in(const LivingTriangle& t, const HeightEncoding& heights,
                                     Spot q);
/// The same where weights_of(t, q) are known.
[[nodiscard]] WeightedCodes codes_in(const LivingTriangle& t, const HeightEncoding& heights, Spot q,
                                     const std::array<Int128, 3>& weights);

}  // namespace ptin
