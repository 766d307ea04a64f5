// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mesh on the grid of another terrain, its triangles found by box.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// The map from one grid to another, by their maps to the same units.
class GridToGrid {
 public:
  GridToGrid(const AffineMap& from, const AffineMap& to);

  [[nodiscard]] MapPoint at(double x, double y) const noexcept {
    return {origin_.x + step_.x * x, origin_.y + step_.y * y};
  }
  /// A box of the grid on which `box` arrives that holds it, limited to `bounds`; may be empty.
  [[nodiscard]] GridBox box_around(const GridBox& box, const GridBox& bounds) const noexcept;
  /// How far at() is at most from the position in real numbers, for positions in `box`. 0 between
  /// grids that are the same.
  [[nodiscard]] double rounding(const GridBox& box) const noexcept;

 private:
  MapPoint origin_, step_;
};

/// Positions of a mesh on another grid, and a tree over its triangles. Threads: one owner.
class OverlayMesh {
 public:
  explicit OverlayMesh(const GridToGrid& map) : map_(map) {}

  /// Bytes for each triangle of the mesh, while it is taken in.
  static constexpr std::uint64_t kBytesATriangle = 72;

  /// Takes in the triangles of `tin` whose boxes meet `near`, on the other grid.
  void take(const Tin& tin, const GridBox& near);
  [[nodiscard]] MapPoint position(VertexId v) const noexcept { return positions_[v]; }
  /// Calls visit(triangle) for each triangle taken in whose box shares more than a side with `box`:
  /// only those share an area.
  template <class Visit>
  void visit(const GridBox& box, const Visit& visit) const {
    const auto overlaps = [&](const GridBox& b) {
      return b.min_x < box.max_x && box.min_x < b.max_x && b.min_y < box.max_y &&
             box.min_y < b.max_y;
    };
    boxes_.visit(overlaps, [&](std::size_t i) { visit(triangles_[i]); });
  }

 private:
  GridToGrid map_;
  std::vector<MapPoint> positions_;
  std::vector<TriangleId> triangles_;
  PackedBoxes boxes_;
};

}  // namespace ptin
