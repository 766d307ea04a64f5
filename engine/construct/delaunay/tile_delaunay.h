// SPDX-License-Identifier: GPL-3.0-or-later
//
// The Delaunay triangulation of any number of points, a tile at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The part of the one Delaunay triangulation of all points that belongs to a tile: the triangles
/// whose smallest vertex (by key: the lowest, then leftmost) is one of the tile's own points. In
/// general a polygon with holes, of several pieces, that may touch itself at a vertex.
struct DelaunayTile {
  /// Vertices in the order of their keys, triangles start with their smallest id and are in
  /// ascending order of (first, second) corner. Beyond the border lies another tile or the
  /// outside.
  Tin tin;
  /// Bit i of each of tin.triangles is set where its side i is on a breakline or the boundary.
  /// Empty where there are none.
  std::vector<std::uint8_t> fixed_sides;
  std::uint64_t own_points = 0;
  std::uint64_t lone_points = 0;   ///< Own points in no surface triangle: they lose their height.
  std::uint64_t other_points = 0;  ///< Points of other tiles that were triangulated with them.
};

/// Cuts tiles out of one triangulation.
///
/// A tile's points are triangulated with what surrounds them: a margin first, then bucket by bucket
/// what lies in the closed circumdisc of a triangle at one of its own points (or beyond an edge of
/// the hull so far). A triangle is final when everything inside of its disc has been seen; where
/// many points lie on a circle the tie is broken by coordinates alone. So tiles are pieces of exactly
/// one triangulation, that of all points.
///
/// Law: the triangulation depends on the set of points alone, so tiles agree wherever a triangle's
/// closed circumdisc lies in what each has seen. Where four or more points lie on one circle the
/// tie is broken by the symbolic perturbation of Devillers and Teillaud (CGAL's): of points on a
/// circle the last one in the order by x, then y, counts as outside of the circle of the others. So
/// it is cut off as an ear, then the last of the remaining ones, and so on: a square cell is cut
/// along its falling diagonal.
///
/// Where there are fixed edges (lines/fixed_edges.h) it is the constrained Delaunay triangulation:
/// these are edges, divided where points lie on them, and no circumdisc holds a point that is
/// visible from the triangle past them (Chew, Constrained Delaunay triangulations, 1989). A triangle is
/// final when all points and fixed edges are in that lie in its closed circumdisc and can be reached
/// from it over sides that are not fixed. Ties are broken as above: the perturbation is one of the
/// lifted points, and with it there is exactly one triangulation in which every edge that is not fixed
/// is locally Delaunay. Triangles outside of a boundary are void.
///
/// Not thread-safe: each thread needs a tiler of its own; any number of them may share the buckets.
class DelaunayTiler {
 public:
  /// @param buckets       Must live as long as this.
  /// @param longest_edge  Triangles with a longer edge are void; none: no triangle is. A length on
  ///                      the ground (grid/crs.h): metres in a geographic CRS, else CRS units.
  /// @param cache_bytes   Memory for points that were looked at around a tile and not inserted.
  explicit DelaunayTiler(const PointBuckets& buckets, std::optional<double> longest_edge = {},
                         std::size_t cache_bytes = std::size_t{16} << 20);

  /// The tile of points first .. first + count - 1 in the order of the buckets.
  /// @throws Error io_error, cancelled
  ///               resource_exhausted  more points than one mesh in memory counts
  /// Cost: about 2 us and 250 bytes a point of the tile and its margin; more points are read, and
  /// kept while they are needed, where discs are large (at the hull, and between clusters).
  [[nodiscard]] DelaunayTile make(std::uint64_t first, std::uint64_t count,
                                  const std::stop_token& stop = {});

 private:
  const PointBuckets& buckets_;
  std::optional<double> longest_edge_;
  GroundMetric ground_;
  std::size_t cache_bytes_;
};

}  // namespace ptin
