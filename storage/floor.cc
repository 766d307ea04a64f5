// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/range_joiner.h"

namespace ptin {

namespace {

layout::FloorPageHead head_of(std::span<const std::byte> page) {
  layout::FloorPageHead head{};
  std::memcpy(&head, page.data(), sizeof head);
  return head;
}

layout::FloorTileEntry entry_of(std::span<const std::byte> page, std::size_t i) {
  layout::FloorTileEntry entry{};
  std::memcpy(&entry, page.data() + sizeof(layout::FloorPageHead) + i * sizeof entry, sizeof entry);
  return entry;
}

/// Where the bytes of the first tile begin.
std::size_t tiles_begin(const layout::FloorPageHead& head) noexcept {
  return sizeof head + head.tiles * sizeof(layout::FloorTileEntry);
}

/// The number of the tile with a key on a page; none: it is not there.
std::optional<std::size_t> tile_on(std::span<const std::byte> page, std::uint64_t key) {
  std::size_t low = 0, high = head_of(page).tiles;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const std::uint64_t there = entry_of(page, middle).key;
    if (there == key) return middle;
    (there < key ? low : high) = there < key ? middle + 1 : middle;
  }
  return std::nullopt;
}

/// What is wrong with a page whose checksum is right: what a program wrote that was not ours.
const char* fault_in(std::span<const std::byte> page) {
  const layout::FloorPageHead head = head_of(page);
  if (head.tiles == 0 || tiles_begin(head) > page.size() || head.bytes > page.size()) {
    return "a page of heights has more tiles than fit, or none";
  }
  std::size_t end = tiles_begin(head);
  for (std::size_t i = 0; i < head.tiles; ++i) {
    const layout::FloorTileEntry entry = entry_of(page, i);
    const bool is_next = i == 0 ? entry.key == 0 : entry.key > entry_of(page, i - 1).key;
    if (!is_next || entry.end < end) return "the tiles of a page of heights are not in order";
    end = entry.end;
  }
  return end == head.bytes ? nullptr : "the tiles of a page of heights do not end where it does";
}

/// What the entry of a tile says of its heights.
Floor::TileBounds bounds_of(const layout::FloorTileEntry& entry, const layout::FloorPageHead& head,
                            HilbertCell at) noexcept {
  if (entry.least > entry.greatest) return {at.x, at.y, UINT32_MAX, 0};
  const std::uint64_t span = head.span;
  const std::uint64_t low = entry.least * span / UINT16_MAX;
  const std::uint64_t high = (entry.greatest * span + UINT16_MAX - 1) / UINT16_MAX;
  return {at.x, at.y, head.least + static_cast<OrderedHeight>(low),
          head.least + static_cast<OrderedHeight>(high)};
}

}  // namespace

Floor::Floor(const ReadableFile& file, const FloorPlace& place, const HeightEncoding& heights)
    : file_(file), place_(place), numbers_(heights, 0.0) {
  IoCounters counters;
  const layout::FloorNode root = node(0, 0, place.root_checksum, counters);
  std::uint64_t pages = 0;
  if (const char* const fault = take_facts(root, facts_, pages)) damaged(fault);
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
  const std::lock_guard lock(slot.lock);
  slot.node = read;
  slot.position = position;
  return read;
}

Floor::Found Floor::find(std::uint64_t key, std::size_t depth, IoCounters& counters) const {
  Found found{0, UINT64_MAX, {0, 0, 0, place_.root_checksum}};
  for (std::size_t level = 0; level < depth; ++level) {
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
  return found;
}

void Floor::announce_at(std::size_t depth, std::span<const std::uint64_t> keys,
                        IoCounters& counters) const {
  const std::uint64_t offset =
      depth == tree_.levels() ? place_.pages.offset
                              : place_.nodes.offset + tree_.position(depth, 0) * layout::kNodeBytes;
  IoCounters counted_when_read;
  RangesToCome ranges(file_, counters);
  RangeJoiner joiner(offset, layout::kFloorPageBytes, ranges);
  for (auto key = keys.begin(); key != keys.end();) {
    const Found found = find(*key, depth, counted_when_read);
    joiner.add(found.number);
    key = std::lower_bound(key, keys.end(), found.end);
  }
}

void Floor::announce(std::span<const std::uint64_t> keys, IoCounters& counters) const {
  if (!is_far()) return;
  for (std::size_t depth = 1; depth <= tree_.levels(); ++depth) announce_at(depth, keys, counters);
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
  if (const char* const fault = fault_in(bytes)) damaged(fault);
  page.number_ = found.number;
  page.first_ = found.entry.first;
}

void Floor::decode(const Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
                   FloorTile& tile) const {
  const std::size_t begin =
      i == 0 ? tiles_begin(head_of(page.bytes_)) : entry_of(page.bytes_, i - 1).end;
  const std::size_t end = entry_of(page.bytes_, i).end;
  const FloorShape& shape = facts_.shape;
  const char* const fault = read_floor_tile(
      std::span<const std::byte>(page.bytes_).subspan(begin, end - begin),
      shape.samples_of(column, shape.width), shape.samples_of(row, shape.height), tile);
  if (fault != nullptr) damaged(fault);
}

void Floor::read(std::uint32_t column, std::uint32_t row, Page& page, FloorTile& tile,
                 IoCounters& counters) const {
  const std::uint64_t key = FloorShape::key(column, row);
  const bool is_there =
      page.number_ != UINT64_MAX && key >= page.first_ && tile_on(page.bytes_, key - page.first_);
  if (!is_there) read_page(find(key, tree_.levels(), counters), page, counters);
  const std::optional<std::size_t> i = tile_on(page.bytes_, key - page.first_);
  if (!i) damaged("a tile of heights is on no page");
  decode(page, *i, column, row, tile);
}

std::vector<std::uint64_t> Floor::keys_of(const Tiles& tiles) const {
  std::vector<std::uint64_t> keys;
  for (std::uint32_t row = tiles.first_row; row <= tiles.last_row; ++row) {
    for (std::uint32_t column = tiles.first_column; column <= tiles.last_column; ++column) {
      keys.push_back(FloorShape::key(column, row));
    }
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<Floor::Found> Floor::pages_of(const std::vector<std::uint64_t>& keys,
                                          const std::function<bool(const TileBounds&)>& wants,
                                          IoCounters& counters) const {
  std::vector<Found> pages;
  for (std::size_t depth = 1; is_far() && depth < tree_.levels(); ++depth) {
    announce_at(depth, keys, counters);
  }
  RangesToCome ranges(file_, counters);
  RangeJoiner joiner(place_.pages.offset, layout::kFloorPageBytes, ranges);
  for (auto key = keys.begin(); key != keys.end();) {
    const Found found = find(*key, tree_.levels(), counters);
    const auto end = std::lower_bound(key, keys.end(), found.end);
    if (std::any_of(key, end, [&](std::uint64_t k) {
          const HilbertCell cell = hilbert_cell(k);
          return wants({cell.x, cell.y, found.entry.least, found.entry.greatest});
        })) {
      pages.push_back(found);
      joiner.add(found.number);
    }
    key = end;
  }
  return pages;
}

bool Floor::visit(const Tiles& tiles, const std::function<bool(const TileBounds&)>& wants,
                  const std::function<bool(const TileBounds&, const FloorTile&)>& take,
                  IoCounters& counters) const {
  const std::vector<std::uint64_t> keys = keys_of(tiles);
  Page page;
  FloorTile tile;
  for (const Found& found : pages_of(keys, wants, counters)) {
    read_page(found, page, counters);
    const layout::FloorPageHead head = head_of(page.bytes_);
    const auto begin = std::lower_bound(keys.begin(), keys.end(), found.entry.first);
    for (auto key = begin; key != keys.end() && *key < found.end; ++key) {
      const std::optional<std::size_t> i = tile_on(page.bytes_, *key - found.entry.first);
      if (!i) damaged("a tile of heights is on no page");
      const HilbertCell cell = hilbert_cell(*key);
      const TileBounds bounds = bounds_of(entry_of(page.bytes_, *i), head, cell);
      if (!wants(bounds)) continue;
      decode(page, *i, cell.x, cell.y, tile);
      if (!take(bounds, tile)) return false;
    }
  }
  return true;
}

}  // namespace ptin
