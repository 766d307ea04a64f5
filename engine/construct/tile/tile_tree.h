// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tree of tiles: over a raster squares of samples that share their border rows, over points
// equal pieces of a space-filling curve; four siblings to a parent (engine/DESIGN.md, section 5.4).
#pragma once

#include <compare>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/geometry/convex_hull.h"

namespace ptin {

/// A window of samples, grid orientation: columns x0 .. x0 + width - 1 from the west, rows from the
/// south.
struct SampleRange {
  std::int64_t x0 = 0, y0 = 0, width = 0, height = 0;
  [[nodiscard]] std::uint64_t samples() const noexcept {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// A tile: level 0 are the leaves.
struct TileId {
  int level = 0;
  std::int64_t x = 0, y = 0;
  friend auto operator<=>(const TileId&, const TileId&) = default;
};

/// Which tiles there are. A function of the raster's size (or the number of points) and the side
/// alone: never of memory or threads.
class TileTree {
 public:
  /// @param width, height  Samples of the raster, at least 2 each.
  /// @param side           Grid units along a leaf; neighbours share the row of samples between
  /// them.
  TileTree(std::int64_t width, std::int64_t height, std::int64_t side);

  /// The tree over points: 4^k leaves that hold equally many, one after the other along the Hilbert
  /// curve. Their windows are those of a raster of as many samples; leaf_number() says which leaf.
  /// @param points  Their number.
  /// @param side    The root of how many a leaf holds at most.
  /// @param hull    Of all points: edges on it are no seams.
  [[nodiscard]] static TileTree over_points(std::uint64_t points, std::int64_t side,
                                            std::shared_ptr<const ConvexHull> hull);
  /// The hull of points; null over a raster.
  [[nodiscard]] const ConvexHull* hull() const noexcept { return hull_.get(); }
  /// Over points: the place along the curve of the leaf that has this window.
  [[nodiscard]] std::uint64_t leaf_number(const SampleRange& window) const noexcept;

  /// The side that is used unless the caller names one: 256 (with which a leaf stays in the
  /// processor's caches: a third faster than 512, for half a percent of vertices), or, beyond 16385
  /// samples, the root of four times the raster's longer side, so that seams weigh little
  /// (side / S^2 in tiles of S); the whole raster when it is no longer than one and a half of
  /// that. Ten times the longer side would need 416 at 16385 samples, and more than
  /// 256 MiB (engine/DECISIONS.md, section 4.1).
  [[nodiscard]] static std::int64_t default_side(std::int64_t width, std::int64_t height) noexcept;

  [[nodiscard]] TileId root() const noexcept { return {levels_ - 1, 0, 0}; }
  [[nodiscard]] int levels() const noexcept { return levels_; }
  [[nodiscard]] std::int64_t side() const noexcept { return side_; }
  [[nodiscard]] std::uint64_t leaves() const noexcept {
    return static_cast<std::uint64_t>(leaves_x_) * static_cast<std::uint64_t>(leaves_y_);
  }
  /// The tiles of level - 1 inside of `id`, in order of y, then x; empty for a leaf. One to four.
  [[nodiscard]] std::vector<TileId> children(const TileId& id) const;
  [[nodiscard]] SampleRange window(const TileId& id) const noexcept;

  /// True when the sample at (x, y), inside of the tile's window, is on a seam: on a side of the
  /// window that is not a side of the raster.
  [[nodiscard]] bool on_seam(const TileId& id, std::int64_t x, std::int64_t y) const noexcept;

 private:
  std::int64_t width_, height_, side_;
  std::int64_t leaves_x_, leaves_y_;
  int levels_ = 1;
  std::shared_ptr<const ConvexHull> hull_;
};

}  // namespace ptin
