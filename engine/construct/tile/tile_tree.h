// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tree of tiles: over a raster squares of samples that share their border rows, over points
// equal pieces of a space-filling curve; four siblings to a parent (engine/DESIGN.md, section 5.4).
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/geometry/convex_hull.h"
#include "engine/geometry/sample_range.h"

namespace ptin {

/// A tile: its level (0: a leaf), and its column and row among the tiles of that level, from the
/// south-west.
struct TileId {
  int level = 0;
  std::int64_t x = 0, y = 0;
  friend auto operator<=>(const TileId&, const TileId&) = default;
};

/// Which tiles there are. They depend on the size of the raster (or the number of points) and the
/// side of a leaf alone, never on memory or threads.
class TileTree {
 public:
  /// The tree over a raster.
  /// @param width, height  Samples of the raster, at least 2 each.
  /// @param side           Grid units along a leaf. Neighbours share a row or column of samples.
  TileTree(std::int64_t width, std::int64_t height, std::int64_t side);

  /// The tree over points, or over the vertices of a TIN: 4^k leaves with equally many points, one
  /// after the other along the Hilbert curve. Its tiles have the windows of a square raster with
  /// about as many samples; leaf_number() says which piece of the curve a leaf is.
  /// @param points  Their number.
  /// @param side    A leaf holds at most side * side points; none: default_side() of a square of as
  ///                many samples.
  /// @param hull    Of all points: edges on it are no seams. Null while they are not known: such a
  ///                tree serves for estimates alone.
  [[nodiscard]] static TileTree over_points(std::uint64_t points, std::optional<std::int64_t> side,
                                            std::shared_ptr<const ConvexHull> hull);
  /// The hull of points; null over a raster.
  [[nodiscard]] const ConvexHull* hull() const noexcept { return hull_.get(); }
  /// Over points: the place, along the curve, of the leaf that has this window.
  [[nodiscard]] std::uint64_t leaf_number(const SampleRange& window) const noexcept;

  /// The side that is used unless the caller names one (engine/DECISIONS.md, section 4.1):
  /// - up to 16385 samples along the longer side: 256, with which a leaf stays in the processor's
  ///   caches: a third faster than 512, for half a percent of vertices;
  /// - beyond: the root of four times the longer side, rounded up to a multiple of 32, so that
  ///   seams weigh little (side / S^2 in tiles of S). Ten times the longer side would need 416 at
  ///   16385 samples, and more than 256 MiB;
  /// - the whole raster where it is no longer than one and a half of that.
  [[nodiscard]] static std::int64_t default_side(std::int64_t width, std::int64_t height) noexcept;

  [[nodiscard]] TileId root() const noexcept { return {levels_ - 1, 0, 0}; }
  [[nodiscard]] int levels() const noexcept { return levels_; }
  [[nodiscard]] std::int64_t side() const noexcept { return side_; }
  [[nodiscard]] std::uint64_t leaves() const noexcept {
    return static_cast<std::uint64_t>(leaves_x_) * static_cast<std::uint64_t>(leaves_y_);
  }
  /// The tiles of the level below inside of `id`, one to four, in order of y, then x; none for a
  /// leaf.
  [[nodiscard]] std::vector<TileId> children(const TileId& id) const;
  [[nodiscard]] SampleRange window(const TileId& id) const noexcept;

  /// True when the sample at (x, y) is on a seam: on a side of the window of the tile that is not a
  /// side of the raster. REQUIRES: it is inside of that window.
  [[nodiscard]] bool on_seam(const TileId& id, std::int64_t x, std::int64_t y) const noexcept;

 private:
  std::int64_t width_, height_, side_;
  std::int64_t leaves_x_, leaves_y_;
  int levels_ = 1;
  std::shared_ptr<const ConvexHull> hull_;
};

}  // namespace ptin
