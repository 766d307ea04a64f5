// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a terrain on the grid of another one, found by box.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/packed_boxes.h"
#include "engine/query/living/living_place.h"

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

/// The triangles of a terrain that meet a box of another grid, and a tree over them there. Threads:
/// one owner.
class OverlayMesh final : private LivingVisitor {
 public:
  /// @param terrain, detail  Borrowed.  @param map  From the terrain's grid to the other one.
  OverlayMesh(const OpenedTerrain& terrain, const Detail& detail, const GridToGrid& map)
      : reader_(terrain, detail), map_(map) {}

  /// Takes in the triangles of `place` that meet `near`, a box of the other grid. False when that
  /// takes more than `most_bytes`; found out before pages are read where their records tell.
  /// @throws Error as LivingReader::read()
  [[nodiscard]] bool gather(const LivingPlace& place, const GridBox& near, std::uint64_t most_bytes,
                            QueryContext& context);
  /// What the last gather() that did not fit would have taken, as far as it came.
  [[nodiscard]] std::uint64_t bytes_wanted() const noexcept { return bytes_wanted_; }

  [[nodiscard]] const LivingTriangle& triangle(std::size_t i) const noexcept {
    return triangles_[i];
  }
  /// The corners on the other grid.
  [[nodiscard]] std::array<MapPoint, 3> corners(const LivingTriangle& t) const noexcept;
  /// Calls visit(i) for each triangle taken in whose box shares more than a side with `box`: only
  /// those share an area.
  template <class Visit>
  void visit(const GridBox& box, const Visit& visit) const {
    const auto overlaps = [&](const GridBox& b) {
      return b.min_x < box.max_x && box.min_x < b.max_x && b.min_y < box.max_y &&
             box.min_y < b.max_y;
    };
    boxes_.visit(overlaps, [&](std::size_t i) { visit(order_[i]); });
  }

 private:
  bool expect(std::uint64_t records) override;
  bool begin(std::size_t most_triangles) override;
  void take(const LivingTriangle& t) override;

  LivingReader reader_;
  GridToGrid map_;
  GridBox near_;
  std::uint64_t most_bytes_ = 0;
  std::uint64_t bytes_wanted_ = 0;
  std::vector<LivingTriangle> triangles_;
  std::vector<std::uint32_t> order_;  ///< Along the Hilbert curve.
  PackedBoxes boxes_;
};

}  // namespace ptin
