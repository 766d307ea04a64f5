// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page of heights as its bytes say it, and the nodes above.
#pragma once

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
    least = least < b.least ? least : b.least;
    greatest = greatest > b.greatest ? greatest : b.greatest;
  }
  [[nodiscard]] bool is_empty() const noexcept { return least > greatest; }
  friend bool operator==(const FloorBounds&, const FloorBounds&) = default;
};

/// Looks at a page. Its bytes are the caller's; kFloorTileTail more can be read behind them.
class FloorPage {
 public:
  /// REQUIRES: kFloorPageBytes of them.
  explicit FloorPage(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {
    std::memcpy(&head_, bytes.data(), sizeof head_);
  }
  /// What is wrong with the page, as a sentence: its checksum can be right all the same. Null where
  /// nothing is; otherwise nothing else may be asked.
  [[nodiscard]] const char* fault() const noexcept;

  [[nodiscard]] std::size_t tiles() const noexcept { return head_.tiles; }
  /// Key of a tile, beyond that of the first one. They ascend.
  [[nodiscard]] std::uint16_t key(std::size_t tile) const noexcept { return entry(tile).key; }
  /// The tile with a key beyond that of the first one; none: it is not there.
  [[nodiscard]] std::optional<std::size_t> find(std::uint64_t key) const noexcept;
  [[nodiscard]] std::span<const std::byte> bytes(std::size_t tile) const noexcept {
    const std::size_t begin = tile == 0 ? first_byte() : entry(tile - 1).end;
    return bytes_.subspan(begin, entry(tile).end - begin);
  }
  /// What the entry of a tile says of its heights: not nearer than they are.
  [[nodiscard]] FloorBounds bounds(std::size_t tile) const noexcept;

 private:
  [[nodiscard]] layout::FloorTileEntry entry(std::size_t tile) const noexcept {
    layout::FloorTileEntry entry{};
    std::memcpy(&entry, bytes_.data() + sizeof head_ + tile * sizeof entry, sizeof entry);
    return entry;
  }
  /// Where the bytes of the first tile begin.
  [[nodiscard]] std::size_t first_byte() const noexcept {
    return sizeof head_ + head_.tiles * sizeof(layout::FloorTileEntry);
  }

  std::span<const std::byte> bytes_;
  layout::FloorPageHead head_{};
};

/// What is wrong with a node that should have so many entries, as a sentence: its checksum can be right
/// all the same. Null where nothing is.
[[nodiscard]] const char* fault_in(const layout::FloorNode& node, std::uint32_t entries) noexcept;

}  // namespace ptin
