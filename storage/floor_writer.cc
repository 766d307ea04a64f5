// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor_writer.h"

#include <algorithm>
#include <cstring>

#include "engine/check.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

/// A height within the span of a page, in 65535ths: not above it, or not below it.
std::uint16_t rounded_down(OrderedHeight height, OrderedHeight least, std::uint32_t span) noexcept {
  if (span == 0) return 0;
  return static_cast<std::uint16_t>(std::uint64_t{height - least} * UINT16_MAX / span);
}
std::uint16_t rounded_up(OrderedHeight height, OrderedHeight least, std::uint32_t span) noexcept {
  if (span == 0) return 0;
  return static_cast<std::uint16_t>((std::uint64_t{height - least} * UINT16_MAX + span - 1) / span);
}

template <class T>
void put(std::vector<std::byte>& page, std::size_t at, const T& structure) {
  std::memcpy(page.data() + at, &structure, sizeof structure);
}

}  // namespace

FloorBounds bounds_of(const FloorTile& tile) noexcept {
  FloorBounds bounds;
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    if (tile.is_void.empty() || tile.is_void[i] == 0) {
      bounds.join({tile.heights[i], tile.heights[i]});
    }
  }
  return bounds;
}

bool FloorPacker::add(std::uint64_t key, const FloorTile& tile) {
  PTIN_CHECK(waiting_.empty() || key > waiting_.back().key);
  const std::size_t before = bytes_.size();
  append_floor_tile(tile, bytes_);
  const std::size_t own = bytes_.size() - before;
  const auto size_with = [](std::size_t tiles, std::size_t bytes) {
    return sizeof(layout::FloorPageHead) + tiles * sizeof(layout::FloorTileEntry) + bytes;
  };
  if (size_with(1, own) > layout::kFloorPageBytes) {
    bytes_.resize(before);
    return false;
  }
  const bool fits = size_with(waiting_.size() + 1, bytes_.size()) <= layout::kFloorPageBytes &&
                    (waiting_.empty() || key - waiting_.front().key < layout::kMostFloorKeys);
  if (!fits) {
    const std::vector<std::byte> next(bytes_.begin() + static_cast<std::ptrdiff_t>(before),
                                      bytes_.end());
    bytes_.resize(before);
    write_waiting();
    bytes_ = next;
  }
  waiting_.push_back({key, own, bounds_of(tile)});
  return true;
}

void FloorPacker::finish() {
  if (!waiting_.empty()) write_waiting();
}

void FloorPacker::write_waiting() {
  FloorBounds all;
  for (const Waiting& tile : waiting_) all.join(tile.bounds);
  const std::uint32_t span = all.is_empty() ? 0 : all.greatest - all.least;
  std::vector<std::byte> page(layout::kFloorPageBytes);
  std::size_t at = sizeof(layout::FloorPageHead);
  std::size_t end = at + waiting_.size() * sizeof(layout::FloorTileEntry);
  std::copy(bytes_.begin(), bytes_.end(), page.begin() + static_cast<std::ptrdiff_t>(end));
  for (const Waiting& tile : waiting_) {
    end += tile.bytes;
    layout::FloorTileEntry entry{static_cast<std::uint16_t>(tile.key - waiting_.front().key),
                                 static_cast<std::uint16_t>(end), UINT16_MAX, 0};
    if (!tile.bounds.is_empty()) {
      entry.least = rounded_down(tile.bounds.least, all.least, span);
      entry.greatest = rounded_up(tile.bounds.greatest, all.least, span);
    }
    put(page, at, entry);
    at += sizeof entry;
  }
  put(page, 0,
      layout::FloorPageHead{static_cast<std::uint16_t>(waiting_.size()),
                            static_cast<std::uint16_t>(end), all.is_empty() ? 0 : all.least, span,
                            0});
  const layout::FloorEntry entry{waiting_.front().key, all.least, all.greatest, checksum_of(page)};
  write_page_(page, entry);
  waiting_.clear();
  bytes_.clear();
}

std::vector<layout::FloorNode> FloorWriter::nodes(const FloorFacts& facts) const {
  const FloorTree tree(entries_.size());
  std::vector<layout::FloorNode> nodes(tree.total_nodes());
  std::vector<layout::FloorEntry> below = entries_;
  for (std::size_t level = tree.levels(); level-- > 0;) {
    std::vector<layout::FloorEntry> here;
    for (std::uint64_t number = 0; number < tree.nodes(level); ++number) {
      layout::FloorNode& node = nodes[tree.position(level, number)];
      const std::size_t first = number * layout::kFloorFanOut;
      node.entries = static_cast<std::uint32_t>(
          std::min<std::size_t>(layout::kFloorFanOut, below.size() - first));
      FloorBounds bounds;
      for (std::uint32_t i = 0; i < node.entries; ++i) {
        node.entry[i] = below[first + i];
        bounds.join({node.entry[i].least, node.entry[i].greatest});
      }
      if (level == 0) put_facts(facts, entries_.size(), node);
      here.push_back(
          {node.entry[0].first, bounds.least, bounds.greatest, checksum_of_object(node)});
    }
    below = std::move(here);
  }
  return nodes;
}

}  // namespace ptin
