// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/heights/window_clip.h"

#include <cstddef>

#include "engine/query/shape/clip.h"

namespace ptin {

std::vector<ClippedCorner> clipped(std::vector<ClippedCorner> polygon, const GridWindow& window) {
  std::vector<ClippedCorner> rest;
  const auto cut_at = [&](std::size_t axis, double at, double inner) {
    rest.clear();
    clip_convex(
        polygon.size(), [&](std::size_t i) { return (polygon[i][axis] - at) * inner; },
        [&](std::size_t i) { rest.push_back(polygon[i]); },
        [&](std::size_t i, std::size_t j) {
          const ClippedCorner &a = polygon[i], &b = polygon[j];
          ClippedCorner cut{};
          for (std::size_t k = 0; k < 3; ++k) cut[k] = meet(a[axis], a[k], b[axis], b[k], at);
          cut[axis] = at;
          rest.push_back(cut);
        });
    polygon.swap(rest);
  };
  cut_at(0, window.min_x, 1);
  cut_at(0, window.max_x, -1);
  cut_at(1, window.min_y, 1);
  cut_at(1, window.max_y, -1);
  return polygon;
}

}  // namespace ptin
