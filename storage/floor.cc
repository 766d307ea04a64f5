// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor.h"

#include <algorithm>
#include <optional>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/floor_page.h"

namespace ptin {

Floor::Floor(const ReadableFile& file, const FloorPlace& place, const HeightEncoding& heights)
    : file_(file), place_(place), heights_(heights), numbers_(heights, 0.0) {
  IoCounters counters;
  root_ = node(0, 0, place.root_checksum, counters);
  std::uint64_t pages = 0;
  if (const char* const fault = take_facts(root_, facts_, pages)) damaged(fault);
  tree_ = FloorTree(pages);
  if (place.nodes.bytes != tree_.total_nodes() * layout::kNodeBytes ||
      place.pages.bytes != pages * layout::kFloorPageBytes) {
    damaged("the sections of heights have not the length that their pages ask for");
  }
  numbers_ = FloorNumbers(heights, facts_.step);
}

void Floor::damaged(const char* what) const {
  throw Error(ErrorCode::corruption, what, file_.path());
}

layout::FloorNode Floor::node(std::size_t level, std::uint64_t number, std::uint64_t checksum,
                              IoCounters& counters) const {
  const std::uint64_t position = tree_.position(level, number);
  if (position == 0 && root_.entries > 0) return root_;
  Slot& slot = slots_[position % kSlots];
  ++counters.index_nodes;
  counters.bytes_read += layout::kNodeBytes;
  {
    const std::lock_guard lock(slot.lock);
    if (slot.position == position) return slot.node;
  }
  layout::FloorNode read{};
  file_.read_at(std::as_writable_bytes(std::span(&read, 1)),
                place_.nodes.offset + position * layout::kNodeBytes);
  if (checksum_of_object(read) != checksum) {
    damaged("a node above the heights does not match its checksum; the file is damaged");
  }
  if (read.entries == 0 || read.entries > layout::kFloorFanOut) {
    damaged("a node above the heights has too many entries, or none");
  }
  const auto is_not_before = [](const layout::FloorEntry& a, const layout::FloorEntry& b) {
    return a.first >= b.first;
  };
  const auto end = read.entry.begin() + read.entries;
  if (std::adjacent_find(read.entry.begin(), end, is_not_before) != end) {
    damaged("the entries of a node above the heights are not in order");
  }
  const std::lock_guard lock(slot.lock);
  slot.node = read;
  slot.position = position;
  return read;
}

Floor::Found Floor::root() const noexcept {
  return {0, UINT64_MAX, {0, 0, 0, place_.root_checksum}, 0};
}

Floor::Found Floor::find(std::uint64_t key, IoCounters& counters) const {
  Found found = root();
  for (std::size_t level = 0; level < tree_.levels(); ++level) {
    const layout::FloorNode here = node(level, found.number, found.entry.checksum, counters);
    const auto end = here.entry.begin() + here.entries;
    const auto after =
        std::upper_bound(here.entry.begin(), end, key,
                         [](std::uint64_t k, const layout::FloorEntry& e) { return k < e.first; });
    if (after == here.entry.begin()) damaged("a tile of heights comes before all pages");
    if (after != end) found.end = after->first;
    found.entry = *(after - 1);
    found.number = found.number * layout::kFloorFanOut +
                   static_cast<std::uint64_t>(after - 1 - here.entry.begin());
    if (found.number >= tree_.entries(level)) {
      damaged("a node above the heights has too many entries");
    }
  }
  found.level = tree_.levels();
  return found;
}

void Floor::read_page(const Found& found, Page& page, IoCounters& counters) const {
  if (page.number_ == found.number) return;
  page.number_ = UINT64_MAX;  // until it is verified
  page.bytes_.resize(layout::kFloorPageBytes + kFloorTileTail);
  const std::span<std::byte> bytes = std::span(page.bytes_).first(layout::kFloorPageBytes);
  file_.read_at(bytes, place_.pages.offset + found.number * layout::kFloorPageBytes);
  ++counters.pages;
  ++counters.pages_verified;
  counters.bytes_read += layout::kFloorPageBytes;
  if (checksum_of(bytes) != found.entry.checksum) {
    damaged("a page of heights does not match its checksum; the file is damaged");
  }
  if (const char* const fault = FloorPageView(bytes).fault()) damaged(fault);
  page.number_ = found.number;
  page.first_ = found.entry.first;
}

void Floor::decode(const Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
                   FloorTile& tile) const {
  const FloorShape& shape = facts_.shape;
  const char* const fault =
      read_floor_tile(page.view().tile(i), shape.samples_of(column, shape.width),
                      shape.samples_of(row, shape.height), tile);
  if (fault != nullptr) damaged(fault);
}

void Floor::read(std::uint32_t column, std::uint32_t row, Page& page, FloorTile& tile,
                 IoCounters& counters) const {
  const std::uint64_t key = FloorShape::key(column, row);
  const bool is_there =
      page.number_ != UINT64_MAX && key >= page.first_ && page.view().tile_with(key - page.first_);
  if (!is_there) read_page(find(key, counters), page, counters);
  const std::optional<std::size_t> i = page.view().tile_with(key - page.first_);
  if (!i) damaged("a tile of heights is on no page");
  decode(page, *i, column, row, tile);
}

}  // namespace ptin
