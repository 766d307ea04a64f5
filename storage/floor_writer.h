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
#include "storage/floor_page.h"
#include "storage/floor_tile.h"
#include "storage/layout.h"

namespace ptin {

/// The least and the greatest height of a tile's samples that are not void.
[[nodiscard]] FloorBounds bounds_of(const FloorTile& tile) noexcept;

/// Packs tiles into pages, as many as fit into each. The bytes depend on the tiles alone.
/// Memory: a page.
class FloorPacker {
 public:
  /// Takes a page, kFloorPageBytes long, and what the node above it says of it.
  using WritePage =
      std::function<void(std::span<const std::byte> page, const layout::FloorEntry& entry)>;
  explicit FloorPacker(WritePage write_page) : write_page_(std::move(write_page)) {}

  /// @param key  FloorShape::key(), above those before.
  /// @return False where the tile alone does not fit into a page; nothing was added then.
  [[nodiscard]] bool add(std::uint64_t key, const FloorTile& tile);
  /// Writes the last page; nothing is added any more.
  void finish();

 private:
  struct Waiting {
    std::uint64_t key;
    std::size_t bytes;  ///< Of the tile, in `bytes_`.
    FloorBounds bounds;
  };
  void write_waiting();

  WritePage write_page_;
  std::vector<Waiting> waiting_;
  std::vector<std::byte> bytes_;  ///< Of the tiles that wait.
};

/// Packs tiles in the order of their keys, and makes the nodes above.
/// Memory: a page, and 24 bytes for each.
class FloorWriter {
 public:
  /// @param write_page  Takes each page, kFloorPageBytes long, in order.
  explicit FloorWriter(const std::function<void(std::span<const std::byte>)>& write_page)
      : packer_([this, write_page](std::span<const std::byte> page, const layout::FloorEntry& e) {
          entries_.push_back(e);
          write_page(page);
        }) {}
  FloorWriter(const FloorWriter&) = delete;
  FloorWriter& operator=(const FloorWriter&) = delete;

  /// As FloorPacker.
  [[nodiscard]] bool add(std::uint64_t key, const FloorTile& tile) {
    return packer_.add(key, tile);
  }
  void finish() { packer_.finish(); }

  [[nodiscard]] std::uint64_t pages() const noexcept { return entries_.size(); }
  /// The nodes above all pages, the root first.  REQUIRES: finish() was called, and there are pages.
  [[nodiscard]] std::vector<layout::FloorNode> nodes(const FloorFacts& facts) const;

 private:
  FloorPacker packer_;
  std::vector<layout::FloorEntry> entries_;
};

}  // namespace ptin
