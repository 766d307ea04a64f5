// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/volume/volume_border.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/geometry/key_table.h"
#include "engine/query/volume/grid_box.h"

namespace ptin {

namespace {

bool is_counted(GridPoint a, GridPoint b, const BorderScope& scope) {
  if (scope.region == nullptr) return true;
  return scope.region->meets(widened(united(box_of(a), b), scope.reach));
}

/// Drops sides of surface triangles from whose lower end no side of a void one goes.
void keep_beside_voids(std::vector<BorderSide>& sides) {
  const auto voids_end =
      std::partition(sides.begin(), sides.end(), [](const BorderSide& s) { return s.is_void; });
  KeyTable lows;
  lows.reset(static_cast<std::size_t>(voids_end - sides.begin()));
  std::for_each(sides.begin(), voids_end, [&](const BorderSide& s) { lows.insert(s.low, 0); });
  sides.erase(
      std::remove_if(voids_end, sides.end(),
                     [&](const BorderSide& s) { return lows.find(s.low) == KeyTable::kAbsent; }),
      sides.end());
}

}  // namespace

double BorderLength::area_within(double reach) const {
  if (parts == 0 || reach == 0) return 0.0;
  return 2 * reach * length.value() + static_cast<double>(parts) * std::numbers::pi * reach * reach;
}

void add_border(std::vector<BorderSide>& sides, const GridBox& tile, const PlaneArea& plane,
                const BorderScope& scope, BorderLength& border) {
  keep_beside_voids(sides);
  std::sort(sides.begin(), sides.end(), [](const BorderSide& x, const BorderSide& y) {
    return x.low != y.low ? x.low < y.low : x.high < y.high;
  });
  std::vector<VertexKey> firsts, seconds;  // lower and higher ends in the tile
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const BorderSide& side = sides[i];
    const BorderSide& other = sides[i + 1];
    if (side.low != other.low || side.high != other.high || side.is_void == other.is_void) continue;
    const GridPoint a = point_of(side.low), b = point_of(side.high);
    if (!is_counted(a, b, scope)) continue;
    if (contains(tile, a)) {
      border.length.add(plane.length_at_most(position_of(a), position_of(b)));
      if (firsts.empty() || firsts.back() != side.low) firsts.push_back(side.low);
    }
    if (contains(tile, b)) seconds.push_back(side.high);
  }
  std::sort(seconds.begin(), seconds.end());
  border.parts +=
      static_cast<std::uint64_t>(std::count_if(firsts.begin(), firsts.end(), [&](VertexKey v) {
        return !std::binary_search(seconds.begin(), seconds.end(), v);
      }));
}

}  // namespace ptin
