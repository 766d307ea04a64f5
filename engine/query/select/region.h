// SPDX-License-Identifier: GPL-3.0-or-later
//
// Regions: in map units as a caller gives them, and on the grid as boxes and triangles are tested
// against them.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/point.h"
#include "engine/query/shape/bins_along_y.h"

namespace ptin {

/// Regions in map units, closed on all sides.
struct Window {
  double min_x, min_y, max_x, max_y;
};
struct Polygon {
  /// Rings of at least three points, without a repeated last point (one is dropped). The interior
  /// is what an odd number of rings surround (even-odd rule), so shells, holes and several parts
  /// are told by nesting alone; borders belong to it.
  std::vector<std::vector<MapPoint>> rings;
};
struct Segment {
  MapPoint a, b;
};
using Region = std::variant<Window, MapPoint, Segment, Polygon>;

/// A window in grid units, as real numbers.
struct GridWindow {
  double min_x, min_y, max_x, max_y;
};
/// A side that was given at vertices, as the centres of pixels are, goes through them: it is moved
/// to their grid coordinate, from which rounding may have it (snapped_to_grid()).
[[nodiscard]] GridWindow on_grid(const Window& window, const AffineMap& map) noexcept;
/// The same in map units: a side that is moved has the map coordinate of vertices, and any other
/// stays as it is.
[[nodiscard]] Window snapped(const Window& window, const AffineMap& map) noexcept;

/// A region on the grid, ready to be tested against boxes (of records, pages, nodes) and triangles.
///
/// Map coordinates become grid coordinates once, as doubles. All rounding errs outward, so a box or
/// triangle that meets the region in real numbers is never lost. The region is widened by the error
/// of that conversion (a few units in the last place of the map coordinates, 1e-9 grid units for
/// UTM metres on a 1 m grid) and, for slanted edges, by that of the test (about 1e-6 grid units;
/// more only for edges that reach far beyond the grid). So a vertex whose rounded map position lies
/// on the region's border is inside. A window holds what on_grid() makes of it, too.
///
/// Laws, for boxes on the grid (0 to kGridMax):
/// - Monotone: contains(b, a) and meets(a) imply meets(b), in floating point too. An edge is tested
///   by comparisons and by its line function at the extreme corners of the box, evaluated as
///   nx * (x - ax) + ny * (y - ay) with constants that do not depend on the box, and each rounded
///   operation is monotone in x and y.
/// - Consistent: meets(a, b, c) implies meets(their box). So when a triangle of a record's fan
///   meets the region, the record's roi, which contains that triangle, meets it too (promise P1).
///
/// Threads: immutable.
class GridRegion {
 public:
  /// @throws Error invalid_argument  a coordinate is not finite or beyond 1e100 grid units; a
  ///                                 window is inverted; a polygon has no ring or one of fewer
  ///                                 than three points
  GridRegion(const Region& region, const AffineMap& map);

  /// True when the closed box shares a point with the region. Exact for windows and points up to
  /// the widening; for segments and polygons conservative by the widening. REQUIRES: `box` not
  /// empty. Cost: a polygon's edges near the box.
  [[nodiscard]] bool meets(const GridBox& box) const noexcept;

  /// A box (grid units) around the region: every box that meets the region meets this one. A little
  /// larger than need be.
  [[nodiscard]] GridBox bounds() const noexcept;

  /// How far, at most, an edge of a segment or a polygon is taken to be from where it is, grid units:
  /// beyond one only where corners are some 10^15 units away.
  [[nodiscard]] double widening() const noexcept { return widening_; }

  /// True only when `box` lies inside of the region: every box within `box` that is not empty meets
  /// the region. False where that is not certain, and always for segments. Law: contains(a) and b
  /// within a imply contains(b) and meets(b). REQUIRES: `box` not empty. Cost: as meets().
  [[nodiscard]] bool contains(const GridBox& box) const noexcept;

  /// True when the closed triangle shares a point with the region, conservative by the widening.
  /// REQUIRES: counter-clockwise.
  [[nodiscard]] bool meets(GridPoint a, GridPoint b, GridPoint c) const noexcept;

 private:
  enum class Kind : std::uint8_t { kRectangle, kSegment, kPolygon };
  enum class Side : std::uint8_t { kOutside, kInside, kBorder };

  /// A position on the grid, and how far the true one may be away.
  struct WidenedPoint {
    double x, y, slack_x, slack_y;
  };
  /// A straight edge a -> b; (nx, ny) points to its right. The box (min_x to max_y) and `slack`
  /// hold the widening already.
  struct Edge {
    double ax, ay, bx, by;
    double min_x, min_y, max_x, max_y;
    double nx, ny;
    double slack;  ///< Values of the line function up to this from 0 may belong to the edge.
    double slack_x, slack_y;  ///< How far the true ends may be away.
  };

  static WidenedPoint widened(MapPoint p, const AffineMap& map);
  static double line(const Edge& e, double x, double y) noexcept {
    return e.nx * (x - e.ax) + e.ny * (y - e.ay);
  }
  static bool touches(const Edge& e, const GridBox& box) noexcept;
  static bool touches(const Edge& e, const GridPoint (&triangle)[3]) noexcept;

  void set_rectangle(const WidenedPoint& low, const WidenedPoint& high);
  void hold(const GridWindow& window) noexcept;
  void add_edge(const WidenedPoint& a, const WidenedPoint& b);
  void add_ring(const std::vector<MapPoint>& ring, const AffineMap& map);
  void sort_edges_into_bins();
  [[nodiscard]] Side side_of(GridPoint p) const noexcept;
  [[nodiscard]] bool rectangle_meets(const GridPoint (&triangle)[3]) const noexcept;
  template <typename Test>
  [[nodiscard]] bool any_edge(const GridBox& box, const Test& test) const noexcept;

  Kind kind_ = Kind::kRectangle;
  double min_x_ = 0, min_y_ = 0, max_x_ = 0,
         max_y_ = 0;  ///< The rectangle, or a box around all edges; widened.
  std::vector<Edge> edges_;
  BinsAlongY bins_;  ///< The edges.
  double widening_ = 0;
};

}  // namespace ptin
