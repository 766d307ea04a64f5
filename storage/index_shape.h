// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the nodes of a packed R-tree lie. All of it follows from the number of pages
// (storage/FORMAT.md, "Index").
#pragma once

#include <array>
#include <cstdint>

#include "storage/layout.h"

namespace ptin {

/// The levels of the packed R-tree over a number of pages. Level 0 are the leaves, whose entries
/// describe pages; entry e of node k of a higher level describes node k * fan-out + e of the level
/// below. In the file the root comes first, then each level from left to right, the leaves last.
class IndexShape {
 public:
  /// Enough for 2^52 pages, more than any file can hold.
  static constexpr std::uint32_t kMaxLevels = 10;

  IndexShape() = default;
  explicit IndexShape(std::uint64_t pages) : pages_(pages) {
    if (pages == 0) {
      return;
    }
    std::uint64_t below = pages;
    do {
      below = (below - 1) / layout::kFanOut + 1;
      nodes_[levels_++] = below;
      total_ += below;
    } while (below > 1 && levels_ < kMaxLevels);
    std::uint64_t first = 0;
    for (std::uint32_t level = levels_; level-- > 0;) {
      first_[level] = first;
      first += nodes_[level];
    }
  }

  /// Number of levels; 0 when there is no page.
  [[nodiscard]] std::uint32_t levels() const noexcept { return levels_; }
  [[nodiscard]] std::uint64_t nodes(std::uint32_t level) const noexcept { return nodes_[level]; }
  [[nodiscard]] std::uint64_t total_nodes() const noexcept { return total_; }
  [[nodiscard]] std::uint64_t total_bytes() const noexcept { return total_ * layout::kNodeBytes; }
  /// Position of a node in the order of the file, from 0 for the root.
  /// REQUIRES: level < levels(), number < nodes(level).
  [[nodiscard]] std::uint64_t position(std::uint32_t level, std::uint64_t number) const noexcept {
    return first_[level] + number;
  }
  /// Number of what the entries of `level` describe: pages for the leaves, nodes of the level below
  /// otherwise.
  [[nodiscard]] std::uint64_t children(std::uint32_t level) const noexcept {
    return level == 0 ? pages_ : nodes_[level - 1];
  }
  /// Entries in use in a node. REQUIRES: as position().
  [[nodiscard]] std::uint32_t entries(std::uint32_t level, std::uint64_t number) const noexcept {
    const std::uint64_t rest = children(level) - number * layout::kFanOut;
    return rest < layout::kFanOut ? static_cast<std::uint32_t>(rest) : layout::kFanOut;
  }

 private:
  std::uint64_t pages_ = 0;
  std::uint64_t total_ = 0;
  std::uint32_t levels_ = 0;
  std::array<std::uint64_t, kMaxLevels> nodes_{};
  std::array<std::uint64_t, kMaxLevels> first_{};
};

}  // namespace ptin
