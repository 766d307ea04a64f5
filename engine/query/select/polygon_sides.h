// SPDX-License-Identifier: GPL-3.0-or-later
//
// The sides of a polygon, found by where they lie; for what is cut at them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/shape/bins_along_y.h"

namespace ptin {

/// The sides of a polygon's rings, in the coordinates in which these are given. Threads: immutable.
class PolygonSides {
 public:
  /// A straight side; `low` is the end with the smaller x, of equal ones with the smaller y, so that
  /// polygons that share a side compute the same from it.
  struct Side {
    MapPoint low, high;
  };
  /// A closed box.
  struct Extent {
    double min_x, min_y, max_x, max_y;
  };

  /// @param rings  Finite coordinates. A side of no length is left out.
  explicit PolygonSides(std::span<const std::vector<MapPoint>> rings);

  /// Most that rounding makes of a distance between places that lie as the sides do. What is no
  /// farther from a side than this lies on it.
  [[nodiscard]] double slack() const noexcept { return slack_; }

  /// Calls visit(side), once each, for all sides whose box, widened by the slack, meets the box.
  template <class Visit>
  void visit_near(const Extent& box, const Visit& visit) const {
    bins_.visit(box.min_y - slack_, box.max_y + slack_, [&](std::uint32_t i) {
      if (meets(sides_[i], box)) visit(sides_[i]);
    });
  }

  /// Whether an odd number of rings surround a place. Within the slack of a side the answer is
  /// either. Cost: the sides that reach its y, or nearly so.
  [[nodiscard]] bool surround(MapPoint p) const;

 private:
  [[nodiscard]] bool meets(const Side& side, const Extent& box) const noexcept {
    const auto [min_y, max_y] = std::minmax(side.low.y, side.high.y);
    return side.low.x - slack_ <= box.max_x && box.min_x <= side.high.x + slack_ &&
           min_y - slack_ <= box.max_y && box.min_y <= max_y + slack_;
  }

  std::vector<Side> sides_;
  BinsAlongY bins_;
  double slack_ = 0.0;
};

}  // namespace ptin
