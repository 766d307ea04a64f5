// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines without heights, and a boundary without, laid on the surface of the points.
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

/// Lays rings and lines on the full TIN of points, part by part. They get a vertex wherever they cross
/// an edge of a surface triangle, with the height of the surface there, so that their sides lie in the
/// surface. Where there is no surface below a ring (outside of the points, or over long edges) its
/// vertices have no ground; of lines such parts are left out.
class LineDrape {
 public:
  using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

  /// @param rings, lines  Without heights.
  /// @param points        Read with these among their lines, so that the grid holds them. Borrowed.
  LineDrape(const LineSet& rings, const LineSet& lines, const PointBuckets& points);

  /// Rings with heights, or without ground, vertex by vertex; and pieces of lines with heights.
  struct Laid {
    LineSet rings, lines;
  };
  /// Lays rings and lines on all parts of the full TIN.
  /// @param longest_edge  As DelaunayTiler.
  /// @throws Error  resource_exhausted  more than `most_vertices` vertices
  ///                as DelaunayTiler::make()
  /// Cost: the triangulation, and the crossings.
  [[nodiscard]] Laid lay(std::optional<double> longest_edge, std::uint64_t most_vertices,
                         const std::stop_token& stop, const Progress& progress = {});
  /// After lay(): the breaklines of the points, or the sides of their boundary, edge by edge, divided
  /// where rings and lines cross them. A vertex there is off the edge by what rounding to the grid moves
  /// it, and could miss it else.
  [[nodiscard]] LineSet divided_lines(bool of_boundary) const;

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

  void add_sides(const LineSet& set, std::vector<GridBox>& boxes);
  void add(const DelaunayTile& part);
  void add(const DelaunayTile& part, TriangleId t, std::uint32_t side);
  [[nodiscard]] double height_in(const Tin& tin, TriangleId t, const Side& side,
                                 double share) const;
  void put_side(std::uint32_t side, std::size_t& next, std::vector<RingVertex>& ring) const;
  void note_crossing(const Side& side, double share);
  void note_heights(const std::vector<RingVertex>& chain);
  void add_ring(std::vector<RingVertex>& ring, LineSet& to);
  void note_points();
  void add_line(const std::vector<RingVertex>& line, LineSet& to) const;
  [[nodiscard]] std::uint32_t edge_at(MapPoint p) const;
  [[nodiscard]] SourcePoint source_point(const RingVertex& v) const;

  const PointBuckets& points_;
  std::vector<Side> sides_;
  std::vector<std::uint32_t> ends_;  ///< One past the last side of each ring, then of each line.
  std::size_t rings_ = 0;
  PackedBoxes boxes_;
  std::vector<Stretch> stretches_;
  std::vector<LineCrossing> crossings_;
  std::unordered_map<VertexKey, double> height_at_;  ///< One at each position.
};

}  // namespace ptin
