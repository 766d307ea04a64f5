// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the nodes of a packed R-tree lie. All of it follows from the numbers of pages of the segments
// (storage/FORMAT.md, "Index").
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "storage/layout.h"

namespace ptin {

/// The levels of the packed R-tree over the pages of some segments, one behind the other. Level 0 are the
/// leaves, whose entries describe pages of one segment: the last leaf of a segment may have room left, so
/// that pages that come or go change no leaf of another one. Entry e of node k of a higher level
/// describes node k * fan-out + e of the level below. In the file the root comes first, then each level
/// from left to right, the leaves last.
/// Memory: 16 bytes a segment.
class IndexShape {
 public:
  /// Enough for 2^52 pages, more than any file can hold.
  static constexpr std::uint32_t kMaxLevels = 10;
  /// A page in a name of 32 bits: its segment, and in these lower bits its number there.
  static constexpr unsigned kNameBits = 16;

  IndexShape() = default;
  /// The shape with a single segment, as files of format 2 have.
  explicit IndexShape(std::uint64_t pages) : IndexShape(std::span(&pages, pages > 0 ? 1 : 0)) {}
  /// @param segments  Pages of each; none has 0.
  explicit IndexShape(std::span<const std::uint64_t> segments) {
    std::uint64_t leaves = 0;
    for (const std::uint64_t pages : segments) {
      first_page_.push_back(pages_);
      first_leaf_.push_back(leaves);
      pages_ += pages;
      leaves += (pages - 1) / layout::kFanOut + 1;
    }
    if (leaves > 0) {
      set_levels(leaves);
    }
  }

  [[nodiscard]] std::uint64_t pages() const noexcept { return pages_; }
  /// Number of levels; 0 when there is no page.
  [[nodiscard]] std::uint32_t levels() const noexcept { return levels_; }
  [[nodiscard]] std::uint64_t nodes(std::uint32_t level) const noexcept { return nodes_[level]; }
  [[nodiscard]] std::uint64_t total_nodes() const noexcept { return total_; }
  [[nodiscard]] std::uint64_t total_bytes() const noexcept { return total_ * layout::kNodeBytes; }
  /// Nodes above the leaves; of a tree without such all.
  [[nodiscard]] std::uint64_t upper_nodes() const noexcept {
    return levels_ < 2 ? total_ : total_ - nodes_[0];
  }
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
  /// The child that entry 0 of a node describes. REQUIRES: as position().
  [[nodiscard]] std::uint64_t first_child(std::uint32_t level,
                                          std::uint64_t number) const noexcept {
    if (level > 0) {
      return number * layout::kFanOut;
    }
    const std::size_t segment = segment_of(first_leaf_, number);
    return first_page_[segment] + (number - first_leaf_[segment]) * layout::kFanOut;
  }
  /// Entries in use in a node. REQUIRES: as position().
  [[nodiscard]] std::uint32_t entries(std::uint32_t level, std::uint64_t number) const noexcept {
    const std::uint64_t end =
        level == 0 ? end_of(segment_of(first_leaf_, number)) : children(level);
    return static_cast<std::uint32_t>(
        std::min<std::uint64_t>(end - first_child(level, number), layout::kFanOut));
  }
  /// The place that a node says of itself: a leaf its segment, above 32 bits of its number there, so that
  /// none of another segment shifts it; another node its number.
  [[nodiscard]] std::uint64_t name_of(std::uint32_t level, std::uint64_t number) const noexcept {
    if (level > 0) {
      return number;
    }
    const std::size_t segment = segment_of(first_leaf_, number);
    return std::uint64_t{segment} << 32 | (number - first_leaf_[segment]);
  }

  /// The entry of a leaf that describes a page. REQUIRES: page < children(0).
  struct LeafEntry {
    std::uint64_t leaf;
    std::uint32_t entry;
  };
  [[nodiscard]] LeafEntry leaf_entry(std::uint64_t page) const noexcept {
    const std::size_t segment = segment_of(first_page_, page);
    const std::uint64_t within = page - first_page_[segment];
    return {first_leaf_[segment] + within / layout::kFanOut,
            static_cast<std::uint32_t>(within % layout::kFanOut)};
  }

  /// Whether each page has a name of 32 bits.
  [[nodiscard]] bool has_page_names() const noexcept {
    constexpr std::uint64_t kMost = std::uint64_t{1} << kNameBits;
    for (std::size_t s = 0; s < first_page_.size(); ++s) {
      if (end_of(s) - first_page_[s] > kMost) return false;
    }
    return first_page_.size() <= kMost;
  }
  /// The name of a page: ascending with its number. REQUIRES: has_page_names(); page < children(0).
  [[nodiscard]] std::uint32_t page_name(std::uint64_t page) const noexcept {
    const std::size_t segment = segment_of(first_page_, page);
    return static_cast<std::uint32_t>(segment << kNameBits | (page - first_page_[segment]));
  }
  /// The page of a name; none where there is no such.
  [[nodiscard]] std::optional<std::uint64_t> page_named(std::uint32_t name) const noexcept {
    const std::size_t segment = name >> kNameBits;
    const std::uint64_t within = name & ((std::uint32_t{1} << kNameBits) - 1);
    if (segment >= first_page_.size() || within >= end_of(segment) - first_page_[segment]) {
      return std::nullopt;
    }
    return first_page_[segment] + within;
  }

 private:
  void set_levels(std::uint64_t leaves) {
    nodes_[levels_++] = total_ = leaves;
    for (std::uint64_t below = leaves; below > 1 && levels_ < kMaxLevels;) {
      below = (below - 1) / layout::kFanOut + 1;
      nodes_[levels_++] = below;
      total_ += below;
    }
    std::uint64_t first = 0;
    for (std::uint32_t level = levels_; level-- > 0;) {
      first_[level] = first;
      first += nodes_[level];
    }
  }
  [[nodiscard]] static std::size_t segment_of(const std::vector<std::uint64_t>& firsts,
                                              std::uint64_t number) noexcept {
    return static_cast<std::size_t>(std::upper_bound(firsts.begin(), firsts.end(), number) -
                                    firsts.begin()) -
           1;
  }
  [[nodiscard]] std::uint64_t end_of(std::size_t segment) const noexcept {
    return segment + 1 < first_page_.size() ? first_page_[segment + 1] : pages_;
  }

  std::uint64_t pages_ = 0;
  std::uint64_t total_ = 0;
  std::uint32_t levels_ = 0;
  std::array<std::uint64_t, kMaxLevels> nodes_{};
  std::array<std::uint64_t, kMaxLevels> first_{};
  std::vector<std::uint64_t> first_page_, first_leaf_;  ///< Of each segment.
};

/// How a directory names pages: in files of format 2 by their numbers.
class PageNames {
 public:
  /// @param shape  Borrowed.
  PageNames(const IndexShape& shape, bool by_segment) : shape_(shape), by_segment_(by_segment) {}
  /// Whether each page has a name.
  [[nodiscard]] bool are_known() const noexcept {
    return by_segment_ ? shape_.has_page_names() : shape_.pages() <= UINT32_MAX;
  }
  /// Ascends with the page's number. REQUIRES: are_known(); page < pages().
  [[nodiscard]] std::uint32_t of(std::uint64_t page) const noexcept {
    return by_segment_ ? shape_.page_name(page) : static_cast<std::uint32_t>(page);
  }
  [[nodiscard]] std::optional<std::uint64_t> page(std::uint32_t name) const noexcept {
    if (by_segment_) return shape_.page_named(name);
    return name < shape_.pages() ? std::optional<std::uint64_t>(name) : std::nullopt;
  }

 private:
  const IndexShape& shape_;
  bool by_segment_;
};

}  // namespace ptin
