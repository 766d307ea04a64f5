// SPDX-License-Identifier: GPL-3.0-or-later
//
// A boundary without heights laid on the surface of the points.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include "engine/construct/delaunay/tile_delaunay.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// Lays rings on the full TIN of points, part by part. A ring gets a vertex wherever it crosses an
/// edge of a surface triangle, with the height of the surface there, so that its sides lie in the
/// surface. Where there is no surface below a ring (outside of the points, or over long edges) its
/// vertices have no ground.
class BoundaryDrape {
 public:
  using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

  /// @param rings   Without heights.
  /// @param points  Read with these rings among their lines, so that the grid holds them. Borrowed.
  BoundaryDrape(const LineSet& rings, const PointBuckets& points);

  /// Lays the rings on all parts of the full TIN.
  /// @param longest_edge  As DelaunayTiler.
  /// @return The rings with heights, or without ground, vertex by vertex.
  /// @throws Error  resource_exhausted  more than `most_vertices` vertices
  ///                as DelaunayTiler::make()
  /// Cost: the triangulation, and the crossings.
  [[nodiscard]] LineSet lay(std::optional<double> longest_edge, std::uint64_t most_vertices,
                            const std::stop_token& stop, const Progress& progress = {});
  /// After lay(): the breaklines of the points, edge by edge, divided where rings cross them. A ring's
  /// vertex there is off the line by what rounding to the grid moves it, and could miss it else.
  [[nodiscard]] LineSet divided_lines() const;

 private:
  /// A side of a ring.
  struct Side {
    GridPoint from, to;
  };
  /// Where one triangle lies below a side: shares of the way along it, and heights there.
  struct Stretch {
    std::uint32_t side = 0;
    double begin = 0.0, end = 0.0;
    double height_at_begin = 0.0, height_at_end = 0.0;
    bool begins_at_line = false, ends_at_line = false;  ///< At a fixed edge.
  };
  /// Where a ring crosses a fixed edge, before and after rounding to the grid.
  struct LineCrossing {
    GridPoint place;
    MapPoint exact;
  };
  struct RingVertex {
    GridPoint position;
    std::optional<double> height;  ///< None: no ground.
    bool on_line = false;          ///< On a fixed edge.
  };

  void add(const DelaunayTile& part);
  void add(const DelaunayTile& part, TriangleId t, std::uint32_t side);
  [[nodiscard]] double height_in(const Tin& tin, TriangleId t, const Side& side,
                                 double share) const;
  void put_side(std::uint32_t side, std::size_t& next, std::vector<RingVertex>& ring) const;
  void note_crossing(const Side& side, double share);
  void add_ring(std::vector<RingVertex>& ring, LineSet& to);
  [[nodiscard]] std::uint32_t edge_at(MapPoint p) const;
  [[nodiscard]] SourcePoint source_point(const RingVertex& v) const;

  const PointBuckets& points_;
  std::vector<Side> sides_;
  std::vector<std::uint32_t> ends_;  ///< Of each ring: one past its last side.
  PackedBoxes boxes_;
  std::vector<Stretch> stretches_;
  std::vector<LineCrossing> crossings_;
  std::unordered_map<VertexKey, double> height_at_;  ///< One at each position.
};

}  // namespace ptin
