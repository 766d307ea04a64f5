// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page of heights as its bytes have it: which tiles it holds, and where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "storage/floor_tile.h"
#include "storage/layout.h"

namespace ptin {

/// Looks at the bytes of a page. Borrowed. Where fault() is not null nothing else may be asked.
class FloorPageView {
 public:
  /// REQUIRES: kFloorPageBytes.
  explicit FloorPageView(std::span<const std::byte> page) noexcept : page_(page) {
    std::memcpy(&head_, page.data(), sizeof head_);
  }

  /// What is wrong with a page whose checksum is right: what a program wrote that was not ours.
  [[nodiscard]] const char* fault() const noexcept;

  [[nodiscard]] std::size_t tiles() const noexcept { return head_.tiles; }
  /// The key of a tile beyond that of the first one.
  [[nodiscard]] std::uint64_t key(std::size_t i) const noexcept { return entry(i).key; }
  /// The number of the tile with such a key; none: it is not there.
  [[nodiscard]] std::optional<std::size_t> tile_with(std::uint64_t key) const noexcept;
  /// The bytes of a tile.
  [[nodiscard]] std::span<const std::byte> tile(std::size_t i) const noexcept {
    const std::size_t begin = i == 0 ? tiles_begin() : entry(i - 1).end;
    return page_.subspan(begin, entry(i).end - begin);
  }
  /// The heights between which a tile's lie, not nearer; least > greatest: all are void.
  struct Heights {
    OrderedHeight least, greatest;
  };
  [[nodiscard]] Heights heights(std::size_t i) const noexcept;

 private:
  [[nodiscard]] layout::FloorTileEntry entry(std::size_t i) const noexcept {
    layout::FloorTileEntry entry;
    std::memcpy(&entry, page_.data() + sizeof head_ + i * sizeof entry, sizeof entry);
    return entry;
  }
  [[nodiscard]] std::size_t tiles_begin() const noexcept {
    return sizeof head_ + head_.tiles * sizeof(layout::FloorTileEntry);
  }

  std::span<const std::byte> page_;
  layout::FloorPageHead head_;
};

}  // namespace ptin
