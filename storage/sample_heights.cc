// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/sample_heights.h"

#include <algorithm>

#include "storage/page_columns.h"

namespace ptin {

void SampleHeights::use(const Floor& floor, IoCounters& counters) {
  counters_ = &counters;
  if (floor_ == &floor) {
    return;
  }
  floor_ = &floor;
  width_ = floor.facts().shape.width;
  height_ = floor.facts().shape.height;
  side_log2_ = floor.facts().shape.side_log2;
  last_column_ = floor.facts().shape.columns() - 1;
  last_row_ = floor.facts().shape.rows() - 1;
  slots_.assign(std::size_t{kSide} * kSide, {});
  tiles_.clear();
  recent_.forget();
}

void SampleHeights::announce(std::span<const GridBox> boxes) {
  // Pages of records, which were announced or will be, are read before them.
  floor_->announce(keys_of(boxes), recent_, *counters_, Coming::kWithNext);
}

void SampleHeights::announce_known(std::span<const GridBox> boxes) {
  floor_->announce_known(keys_of(boxes), recent_, *counters_);
}

/// The keys of the tiles that meet the boxes, ascending.
std::vector<std::uint64_t> SampleHeights::keys_of(std::span<const GridBox> boxes) const {
  std::vector<std::uint64_t> keys;
  const auto tile = [this](std::int32_t v, std::uint32_t last) {
    return std::min(static_cast<std::uint32_t>(std::max(v, 0) >> side_log2_), last);
  };
  for (const GridBox& box : boxes) {
    for (std::uint32_t row = tile(box.min_y, last_row_); row <= tile(box.max_y, last_row_); ++row) {
      for (std::uint32_t column = tile(box.min_x, last_column_);
           column <= tile(box.max_x, last_column_); ++column) {
        keys.push_back(FloorShape::key(column, row));
      }
    }
  }
  std::ranges::sort(keys);
  const auto twice = std::ranges::unique(keys);
  keys.erase(twice.begin(), twice.end());
  return keys;
}

void SampleHeights::read(std::uint32_t column, std::uint32_t row) {
  Slot& slot = slots_[place(column, row)];
  slot.column = kNone;  // until it is read
  floor_->read(column, row, recent_, read_tile_, *counters_);
  if (slot.tile == kNone) {
    slot.tile = static_cast<std::uint32_t>(tiles_.size());
    tiles_.emplace_back();
  }
  std::vector<OrderedHeight>& heights = tiles_[slot.tile];
  std::swap(heights, read_tile_.heights);
  floor_->numbers().to_ordered_heights(heights);
  for (std::size_t i = 0; i < read_tile_.is_void.size(); ++i) {
    if (read_tile_.is_void[i] != 0) heights[i] = 0;
  }
  slot.heights = heights.data();
  slot.width = read_tile_.width;
  slot.column = column;
  slot.row = row;
}

}  // namespace ptin
