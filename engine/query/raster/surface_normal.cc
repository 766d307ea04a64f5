// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/surface_normal.h"

#include <algorithm>

namespace ptin {

std::array<CodedPoint, 3> from_least(const std::array<CodedPoint, 3>& corners) {
  std::array<CodedPoint, 3> turned = corners;
  const auto least =
      std::min_element(turned.begin(), turned.end(), [](const CodedPoint& a, const CodedPoint& b) {
        return key_of(a.position) < key_of(b.position);
      });
  std::rotate(turned.begin(), least, turned.end());
  return turned;
}

GridNormal normal_of(const std::array<CodedPoint, 3>& corners) {
  const auto [a, b, c] = from_least(corners);
  const auto from_a = [&a = a](const CodedPoint& p) {
    return std::array<double, 3>{static_cast<double>(p.position.x) - a.position.x,
                                 static_cast<double>(p.position.y) - a.position.y, p.code - a.code};
  };
  const auto [bx, by, bh] = from_a(b);
  const auto [cx, cy, ch] = from_a(c);
  return {by * ch - bh * cy, bh * cx - bx * ch, bx * cy - by * cx};
}

}  // namespace ptin
