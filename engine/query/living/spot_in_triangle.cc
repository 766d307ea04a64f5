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
  return codes_in(t, heights, q, weights_of(t, q));
}

WeightedCodes codes_in(const LivingTriangle& t, const HeightEncoding& heights, Spot q,
                       const std::array<Int128, 3>& weights) {
  std::array<std::size_t, 3> corners{0, 1, 2};  // by key, so that both sides of an edge agree
  std::sort(corners.begin(), corners.end(), [&](std::size_t a, std::size_t b) {
    return key_of(t.corner[a].position) < key_of(t.corner[b].position);
  });
  WeightedCodes codes;
  std::array<GridPoint, 3> at;
  for (const std::size_t i : corners) {
    if (weights[i] != 0) {
      const auto k = static_cast<std::size_t>(codes.count++);
      at[k] = t.corner[i].position;
      codes.code[k] = heights.code(t.corner[i].height);
      codes.weight[k] = weights[i];
    }
  }
  if (codes.count == 2) {
    const auto [a, b] = edge_weights(at[0], at[1], q);
    codes.weight = {a, b, 0};
  }
  return codes;
}

}  // namespace ptin
