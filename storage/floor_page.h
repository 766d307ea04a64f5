// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page of heights as its bytes have it: which tiles it holds, and where. And the nodes above.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "storage/floor_tile.h"
#include "storage/layout.h"

namespace ptin {

/// Heights from the least to the greatest. Of void samples alone there are none.
struct FloorBounds {
  OrderedHeight least = UINT32_MAX, greatest = 0;
  void join(const FloorBounds& b) noexcept {
    least = std::min(least, b.least);
    greatest = std::max(greatest, b.greatest);
  }
  [[nodiscard]] bool is_empty() const noexcept { return least > greatest; }
};

/// What is wrong with a node that should have so many entries, as a sentence: its checksum can be right
/// all the same. Null where nothing is.
[[nodiscard]] const char* fault_in(const layout::FloorNode& node, std::uint32_t entries) noexcept;

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
  /// The heights between which a tile's lie, not nearer.
  [[nodiscard]] FloorBounds heights(std::size_t i) const noexcept;

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
