// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles of heights into pages, and the nodes above them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "storage/floor_facts.h"
#include "storage/floor_tile.h"
#include "storage/layout.h"

namespace ptin {

/// Packs tiles in the order of their keys. The bytes depend on the tiles alone.
/// Memory: a page, and 24 bytes for each.
class FloorWriter {
 public:
  /// @param write_page  Takes each page, kFloorPageBytes long, in order.
  explicit FloorWriter(std::function<void(std::span<const std::byte>)> write_page)
      : write_page_(std::move(write_page)) {}

  /// @param key  FloorShape::key(), above those before.
  /// @return False where the tile alone does not fit into a page; nothing was added then.
  [[nodiscard]] bool add(std::uint64_t key, const FloorTile& tile);
  /// Writes the last page; nothing is added any more.
  void finish();

  [[nodiscard]] std::uint64_t pages() const noexcept { return entries_.size(); }
  /// The nodes above all pages, the root first.  REQUIRES: finish() was called, and there are pages.
  [[nodiscard]] std::vector<layout::FloorNode> nodes(const FloorFacts& facts) const;

 private:
  struct Bounds {
    OrderedHeight least = UINT32_MAX, greatest = 0;
    void join(const Bounds& b) noexcept;
    [[nodiscard]] bool is_empty() const noexcept { return least > greatest; }
  };
  struct Waiting {
    std::uint64_t key;
    std::size_t bytes;  ///< Of the tile, in `bytes_`.
    Bounds bounds;
  };
  static Bounds bounds_of(const FloorTile& tile);
  void write_waiting();

  std::function<void(std::span<const std::byte>)> write_page_;
  std::vector<Waiting> waiting_;
  std::vector<std::byte> bytes_;  ///< Of the tiles that wait.
  std::vector<layout::FloorEntry> entries_;
};

}  // namespace ptin
