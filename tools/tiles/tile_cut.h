// SPDX-License-Identifier: GPL-3.0-or-later
//
// Triangles of a level cut at the borders of one tile, so that both neighbours cut in the same
// points.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "tools/tiles/level_mesh.h"

namespace ptin::tools {

/// Cuts triangles at a tile's borders, first at the western and the eastern one, then at the other
/// two. A cut point is computed from the two ends of the whole edge, the lower one first, and
/// rounded to the lattice along the border. Hence
/// - tiles side by side have equal points on their border: each comes from an edge of the mesh, or,
///   at a corner, from two such points;
/// - tiles one above the other have equal points, because both cut the same column first;
/// - the two triangles at an edge have equal points, so a tile has no crack.
/// Threads: one owner.
class TileCut {
 public:
  using Id = LevelMesh::Id;

  /// @param mesh  Borrowed. Points of it keep their numbers; cut points have those after them.
  TileCut(const LevelMesh& mesh, const TileBox& tile) : mesh_(mesh), tile_(tile) {}

  /// The part of a triangle within the tile, counter-clockwise: empty, or at least three points.
  /// What has no area is kept where it has three points: it closes the gap beside a point that was
  /// rounded onto an edge. Valid until the next call.
  [[nodiscard]] const std::vector<Id>& cut(const LevelMesh::Corners& triangle);
  /// Twice the area of what cut() returned, in squares of the lattice.
  [[nodiscard]] std::int64_t twice_area() const noexcept;

  [[nodiscard]] const LevelPoint& point(Id id) const noexcept {
    const std::size_t old = mesh_.points().size();
    return id < old ? mesh_.points()[id] : cuts_[id - old].point;
  }
  /// The unit normal at a point. It is that of the triangles around the point. At a cut point whose
  /// edge has both its ends nearby it lies between those of the ends, so that shading goes on
  /// across the border.
  [[nodiscard]] Vec3 normal(Id id) const;

  /// How far from a border vertices are looked at for normals on it, in steps of the lattice: a
  /// mesh must hold what meets the tile widened by this.
  static constexpr std::int64_t kNearby = kTileSteps / 12;

 private:
  enum class Axis : std::uint8_t { kU, kV };
  struct Border {
    Axis axis;
    std::int64_t at;
    bool is_upper;  ///< What is beyond `at` is outside.
  };
  struct CutPoint {
    LevelPoint point;
    Id low, high;  ///< Ends of the edge, lower first along the axis.
    double share;  ///< Share of the way from low to high.
    Axis axis;
  };

  [[nodiscard]] bool is_cut(Id id, Axis axis) const noexcept {
    const std::size_t old = mesh_.points().size();
    return id >= old && cuts_[id - old].axis == axis;
  }
  void cut_at(const Border& border);
  [[nodiscard]] Id cross(Id a, Id b, const Border& border);
  [[nodiscard]] CutPoint cut_point(Id low, Id high, const Border& border) const;

  const LevelMesh& mesh_;
  TileBox tile_;
  std::array<std::int64_t, 3> normal_{};  ///< Normal of the triangle that is being cut.
  std::vector<Id> polygon_, rest_;
  std::vector<CutPoint> cuts_;
  std::array<std::unordered_map<std::uint64_t, Id>, 4> known_;  ///< By border, then by ends.
};

}  // namespace ptin::tools
