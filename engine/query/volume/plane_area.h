// SPDX-License-Identifier: GPL-3.0-or-later
//
// Areas over ground, and integrals over them of functions that are linear on the grid.
#pragma once

#include <array>
#include <functional>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"

namespace ptin {

/// How areas and lengths on a grid become those over ground.
struct GroundScale {
  /// The length over ground, at a position in map units, of one map unit along x and of one along y;
  /// it depends on y alone. Null: 1.
  std::function<MapPoint(MapPoint)> per_map_unit;
  bool is_uniform = true;  ///< The same everywhere; false where map units are degrees.
};

/// A triangle with a function that is linear on it, as integration needs it: the shape does not
/// matter, only its area and where its corners lie along y.
struct Facet {
  double area = 0.0;          ///< Square grid units.
  std::array<double, 3> y{};  ///< The corners' y, grid units.
  std::array<double, 3> f{};  ///< The function at the corners.
};

/// What a facet has above 0.
struct PositivePart {
  double volume = 0.0;  ///< The integral of max(f, 0) over ground.
  double area = 0.0;    ///< Where f > 0, over ground.
};

/// Integrates over the ground below one grid. Where a step of the grid has the same length
/// everywhere, integrals are closed forms. In degrees they are those of a rule of degree five (Radon,
/// 1948; seven points) over facets that span at most two degrees along y: a part in 10^11 off at most.
/// Threads: immutable.
class PlaneArea {
 public:
  PlaneArea(const AffineMap& map, const GroundScale& scale);

  [[nodiscard]] double area(const Facet& facet) const;
  [[nodiscard]] double integral(const Facet& facet) const;
  /// Splits the facet where f is 0: the parts have no cancellation.
  [[nodiscard]] PositivePart positive(const Facet& facet) const;
  /// No less than the length over ground of a segment between two positions on the grid.
  [[nodiscard]] double length_at_most(MapPoint a, MapPoint b) const;
  /// No less than the area over ground of a box.
  [[nodiscard]] double area_at_most(const GridBox& box) const;
  /// About the area over ground of a strip of this length and width (grid units) at `y`.
  [[nodiscard]] double strip_area(double length, double width, double y) const {
    return 2 * length * width * density(y);
  }
  [[nodiscard]] bool is_uniform() const noexcept { return scale_.is_uniform; }
  /// How many grid units along x and along y are at least `length` over ground, anywhere in `box`.
  [[nodiscard]] MapPoint grid_reach(double length, const GridBox& box) const;

 private:
  /// The length over ground of one grid unit along x and along y.
  [[nodiscard]] MapPoint unit_at(double grid_y) const {
    if (scale_.is_uniform) return uniform_;
    const MapPoint unit = scale_.per_map_unit(map_.to_map(0, grid_y));
    return {map_.step_x * unit.x, map_.step_y * unit.y};
  }
  [[nodiscard]] double density(double grid_y) const {
    const MapPoint unit = unit_at(grid_y);
    return unit.x * unit.y;
  }
  [[nodiscard]] MapPoint largest_unit(double y0, double y1) const;

  AffineMap map_;
  GroundScale scale_;
  MapPoint uniform_;  ///< As unit_at(), where it is the same everywhere.
};

}  // namespace ptin
