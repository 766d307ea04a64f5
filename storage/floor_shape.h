// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the samples of a raster are cut into tiles, and how the nodes above their pages stand.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/hilbert.h"
#include "storage/layout.h"

namespace ptin {

/// Tiles from a column and a row to others, these too.
struct TileRange {
  std::uint32_t first_column, first_row, last_column, last_row;
};

/// Tiles of a raster: 2^side_log2 cells along each side, fewer at its end.
struct FloorShape {
  std::uint32_t side_log2 = 5;
  std::uint32_t width = 0, height = 0;  ///< Samples of the raster.

  /// The place of a tile along the Hilbert curve, by which tiles are ordered.
  [[nodiscard]] static std::uint64_t key(std::uint32_t column, std::uint32_t row) noexcept {
    return hilbert_position(column, row);
  }
  [[nodiscard]] std::uint32_t columns() const noexcept { return tiles_along(width); }
  [[nodiscard]] std::uint32_t rows() const noexcept { return tiles_along(height); }
  [[nodiscard]] std::uint64_t tiles() const noexcept { return std::uint64_t{columns()} * rows(); }
  /// The first sample of a column of tiles, or of a row.
  [[nodiscard]] std::uint32_t first_of(std::uint32_t tile) const noexcept {
    return tile << side_log2;
  }
  /// Samples of a column of tiles; of a row with `height`.
  [[nodiscard]] std::uint32_t samples_of(std::uint32_t tile, std::uint32_t all) const noexcept {
    return std::min((1U << side_log2) + 1, all - first_of(tile));
  }

  /// The places of the samples of some tiles, grid units.
  [[nodiscard]] GridBox samples_of(const TileRange& tiles) const noexcept {
    const auto last = [this](std::uint32_t tile, std::uint32_t all) {
      return static_cast<std::int32_t>(first_of(tile) + samples_of(tile, all) - 1);
    };
    return {static_cast<std::int32_t>(first_of(tiles.first_column)),
            static_cast<std::int32_t>(first_of(tiles.first_row)), last(tiles.last_column, width),
            last(tiles.last_row, height)};
  }

 private:
  /// A raster of one row or column of samples has no cells, and one row or column of tiles.
  [[nodiscard]] std::uint32_t tiles_along(std::uint32_t samples) const noexcept {
    const std::uint32_t side = 1U << side_log2;
    return samples < 2 ? 1 : (samples - 2) / side + 1;
  }
};

/// The nodes above some pages: the root first, then level by level, the leaves last.
class FloorTree {
 public:
  explicit FloorTree(std::uint64_t pages) : pages_(pages) {
    std::uint64_t below = pages;
    do {
      below = (below + layout::kFloorFanOut - 1) / layout::kFloorFanOut;
      nodes_.insert(nodes_.begin(), below);
    } while (below > 1);
  }
  [[nodiscard]] std::uint64_t pages() const noexcept { return pages_; }
  /// 0 is the root's level.
  [[nodiscard]] std::size_t levels() const noexcept { return nodes_.size(); }
  [[nodiscard]] std::uint64_t nodes(std::size_t level) const noexcept { return nodes_[level]; }
  /// The entries of all nodes of a level: nodes of the next one, or pages.
  [[nodiscard]] std::uint64_t entries(std::size_t level) const noexcept {
    return level + 1 < nodes_.size() ? nodes_[level + 1] : pages_;
  }
  /// The entries of one node of a level.
  [[nodiscard]] std::uint32_t children(std::size_t level, std::uint64_t number) const noexcept {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(
        layout::kFloorFanOut, entries(level) - number * layout::kFloorFanOut));
  }
  [[nodiscard]] std::uint64_t position(std::size_t level, std::uint64_t number) const noexcept {
    for (std::size_t i = 0; i < level; ++i) number += nodes_[i];
    return number;
  }
  [[nodiscard]] std::uint64_t total_nodes() const noexcept { return position(nodes_.size(), 0); }

 private:
  std::uint64_t pages_;
  std::vector<std::uint64_t> nodes_;
};

}  // namespace ptin
