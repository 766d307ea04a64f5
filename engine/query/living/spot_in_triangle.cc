// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/spot_in_triangle.h"

#include <algorithm>

namespace ptin {

std::array<Int128, 3> weights_of(const LivingTriangle& t, Spot q) {
  return {side(t.corner[1].position, t.corner[2].position, q),
          side(t.corner[2].position, t.corner[0].position, q),
          side(t.corner[0].position, t.corner[1].position, q)};
}

WeightedCodes codes_in(const LivingTriangle& t, const HeightEncoding& heights, Spot q) {
  const std::array<Int128, 3> of_corner = weights_of(t, q);
  std::array<std::size_t, 3> corners{0, 1, 2};  // by key, so that both sides of an edge agree
  std::sort(corners.begin(), corners.end(), [&](std::size_t a, std::size_t b) {
    return key_of(t.corner[a].position) < key_of(t.corner[b].position);
  });
  WeightedCodes codes;
  for (const std::size_t i : corners) {
    if (of_corner[i] != 0) {
      const auto k = static_cast<std::size_t>(codes.count++);
      codes.code[k] = heights.code(t.corner[i].height);
      codes.weight[k] = of_corner[i];
    }
  }
  return codes;
}

}  // namespace ptin
