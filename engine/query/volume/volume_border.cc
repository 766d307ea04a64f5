// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/volume_border.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/query/volume/grid_box.h"

namespace ptin {

namespace {

bool is_counted(GridPoint a, GridPoint b, const BorderScope& scope) {
  if (scope.region == nullptr) return true;
  return scope.region->meets(widened(united(box_of(a), b), scope.reach));
}

}  // namespace

double BorderLength::area_within(double reach) const {
  if (parts == 0 || reach == 0) return 0.0;
  return 2 * reach * length.value() + static_cast<double>(parts) * std::numbers::pi * reach * reach;
}

void add_border(const Tin& tin, const GridBox& tile, const PlaneArea& plane,
                const BorderScope& scope, BorderLength& border) {
  enum : std::uint8_t { kNotSeen, kFirst, kNotFirst };
  std::vector<std::uint8_t> seen(tin.vertices.size(), kNotSeen);
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (tin.classes[t] != TriangleClass::kSurface) continue;
    const Triangle& triangle = tin.triangles[t];
    for (int i = 0; i < 3; ++i) {
      const TriangleId n = triangle.n[i];
      if (n == kNone || tin.classes[n] == TriangleClass::kSurface) continue;
      VertexId low = triangle.v[next_corner(i)], high = triangle.v[previous_corner(i)];
      if (key_of(tin.position(high)) < key_of(tin.position(low))) std::swap(low, high);
      const GridPoint a = tin.position(low), b = tin.position(high);
      const bool is_near = contains(tile, a) || contains(tile, b);
      if (!is_near || !is_counted(a, b, scope)) continue;
      seen[high] = kNotFirst;
      seen[low] = std::max<std::uint8_t>(seen[low], kFirst);
      if (contains(tile, a))
        border.length.add(plane.length_at_most(position_of(a), position_of(b)));
    }
  }
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    border.parts += seen[v] == kFirst && contains(tile, tin.position(v)) ? 1 : 0;
  }
}

}  // namespace ptin
