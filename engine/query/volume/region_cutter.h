// SPDX-License-Identifier: GPL-3.0-or-later
//
// Convex pieces cut at a window or a polygon.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/query/select/region.h"
#include "engine/query/shape/bins_along_y.h"
#include "engine/query/volume/convex_piece.h"

namespace ptin {

/// Cuts convex pieces at a region, by the even-odd rule: rings may nest, cross and touch. The
/// region's corners are rounded to doubles on the grid; cuts are rounded as those of ConvexPiece.
///
/// A piece on the border is divided into slabs along y, between which no edge of the region begins,
/// ends or crosses another; in a slab the region is every other space between two edges, a
/// trapezoid. A piece that many edges meet is halved first.
/// Threads: immutable.
class RegionCutter {
 public:
  /// @throws Error invalid_argument  the region has no inside (a point, a segment); as GridRegion
  RegionCutter(const Region& region, const AffineMap& map);

  /// Appends to `parts` convex pieces without overlap that make up the part of `piece` in the region.
  /// @throws Error resource_exhausted  too many edges meet in one place
  /// Cost: a look at the piece's box, and on the border the edges near the piece, sorted.
  void cut(const ConvexPiece& piece, std::vector<ConvexPiece>& parts) const;
  /// On the grid, conservative.
  [[nodiscard]] const GridRegion& region() const noexcept { return region_; }

 private:
  /// An edge, its lower end first. A horizontal one begins a slab, and is a side of none.
  struct Edge {
    MapPoint low, high;

    [[nodiscard]] double x_at(double y) const {
      if (y <= low.y) return low.x;
      if (y >= high.y) return high.x;
      return low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x);
    }
  };
  using Edges = std::vector<const Edge*>;

  /// How often a piece was halved, how often of late in vain, and the edges in it before the last.
  struct Halvings {
    int all = 0, in_vain = -1;
    std::size_t edges = 0;
    std::uint64_t* looks = nullptr;  ///< What has been looked at for the whole piece.
  };

  static GridWindow extent_of(const ConvexPiece& piece);
  void add_ring(std::span<const MapPoint> ring, const AffineMap& map);
  void cancel_pairs();
  [[nodiscard]] Edges edges_along(const GridWindow& extent) const;
  static void cut_along(const ConvexPiece& piece, const Edges& along, Halvings done,
                        std::vector<ConvexPiece>& parts);
  static std::vector<double> slab_ends(const GridWindow& extent, const Edges& local);
  static void cut_in_slab(const ConvexPiece& piece, double low, double high, const Edges& local,
                          const Edges& left, std::vector<ConvexPiece>& parts);

  GridRegion region_;
  std::vector<Edge> edges_;
  BinsAlongY bins_;  ///< The edges.
};

}  // namespace ptin
