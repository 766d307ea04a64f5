// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/pixel_normals.h"

#include <algorithm>
#include <utility>

#include "engine/query/shape/spot.h"

namespace ptin {

void PixelNormals::add(const LivingTriangle& t) {
  if (t.is_void || centres_.misses(box_of(t))) return;
  std::array<CodedPoint, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = {t.corner[i].position, encoding_.code(t.corner[i].height)};
  }
  triangles_.push_back(from_least(corners));
}

void PixelNormals::sum_up(std::span<GridNormal> normals, std::size_t stride) {
  // Two triangles never share their least corner and the one behind it.
  const auto order = [](const std::array<CodedPoint, 3>& t) {
    return std::pair(key_of(t[0].position), key_of(t[1].position));
  };
  std::sort(triangles_.begin(), triangles_.end(),
            [&](const auto& a, const auto& b) { return order(a) < order(b); });
  for (const std::array<CodedPoint, 3>& t : triangles_) {
    const GridNormal normal = normal_of(t);
    const auto [a, b, c] = std::array{t[0].position, t[1].position, t[2].position};
    centres_.near(a, b, c, [&, a = a, b = b, c = c](std::size_t place, Spot q) {
      if (!triangle_holds(a, b, c, q)) return;
      GridNormal& sum = normals[place / centres_.width() * stride + place % centres_.width()];
      sum = {sum.x + normal.x, sum.y + normal.y, sum.z + normal.z};
    });
  }
  triangles_.clear();
}

}  // namespace ptin
