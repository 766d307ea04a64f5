// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangles of a TIN laid on the globe, before they are cut at the borders of tiles.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <stop_token>
#include <utility>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/questions.h"
#include "tools/tiles/globe.h"
#include "tools/tiles/tile_grid.h"
#include "tools/tiles/tile_levels.h"

namespace ptin::tools {

/// A vertex of the mesh, or a cut point on one of its edges.
struct LevelPoint {
  TilePoint at;         ///< Rounded to the level's lattice.
  double height = 0.0;  ///< Metres, not rounded.
  /// The sum of the normals of the triangles around it, each as long as twice its area, in whole
  /// units of LevelMesh: a sum of integers is the same in whatever order it is formed.
  std::array<std::int64_t, 3> normal{};
};

/// What a mesh is made for.
struct LevelFrame {
  TileGrid grid;
  int level = 0;
  TileLevel plan;
};

/// The part of one level that meets a box of its lattice. An edge whose middle is farther than the
/// level's `chord` from where it is on the TIN, in space, is cut in two there, again and again:
/// so edges follow the curved Earth and straight lines of the CRS. Whether it is depends on its ends
/// alone. So do positions, heights and, for points within the box, normals: two meshes of the same
/// level have equal bits where both their boxes are. Threads: one owner.
class LevelMesh {
 public:
  using Id = std::uint32_t;
  using Corners = std::array<Id, 3>;

  /// @param path  Borrowed.
  /// @param keep  Triangles that do not meet it are left out.
  /// @param most_triangles  More than these are refused.
  LevelMesh(LevelFrame frame, const GlobePath& path, const TileBox& keep,
            std::uint64_t most_triangles);

  /// Adds the surface triangles of a TIN.
  /// @throws Error resource_exhausted  more triangles than may be
  ///               invalid_argument    as GlobePath::to_globe()
  ///               cancelled
  /// Cost: linear; for each vertex what PROJ takes.
  void add(const Tin& tin, const StoreFacts& facts, const std::stop_token& stop);

  [[nodiscard]] const LevelFrame& frame() const noexcept { return frame_; }
  [[nodiscard]] const std::vector<LevelPoint>& points() const noexcept { return points_; }
  [[nodiscard]] const std::vector<Corners>& triangles() const noexcept { return triangles_; }
  [[nodiscard]] TileBox box_of(const Corners& t) const noexcept;
  /// The normal of one triangle, in the units of LevelPoint::normal.
  [[nodiscard]] std::array<std::int64_t, 3> normal_of(const Corners& t) const noexcept;

  /// Bytes that a triangle takes, with its share of the vertices, about.
  static constexpr std::uint64_t kBytesATriangle = 256;

 private:
  /// Where a vertex is, beside its LevelPoint.
  struct Place {
    double x = 0.0, y = 0.0;  ///< Grid units; a middle of an edge lies between grid points.
    double height = 0.0;      ///< Height's unit.
    Vec3 in_space;
  };

  Id add_vertex(double x, double y, double height);
  Id middle_of(Id a, Id b);
  [[nodiscard]] bool is_too_long(Id a, Id b);
  void add_triangle(const Corners& t, int depth);
  void keep_triangle(const Corners& t);

  LevelFrame frame_;
  const GlobePath& path_;
  TileBox keep_;
  std::uint64_t most_triangles_;
  double short_square_;  ///< Edges of this length squared bend too little to be looked at.
  double normal_scale_;
  std::vector<LevelPoint> points_;
  std::vector<Place> places_;  ///< One for each of `points_`.
  std::vector<Corners> triangles_;
  std::map<std::pair<double, double>, Id> middles_;
};

}  // namespace ptin::tools
