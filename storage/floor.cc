// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor.h"

#include <algorithm>
#include <array>
#include <optional>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/file/range_joiner.h"
#include "storage/floor_page.h"

namespace ptin {

namespace {

/// Tiles that are looked for together.
constexpr std::size_t kTilesAtOnce = 8192;

/// The tiles of a rectangle by their keys, ascending, some at a time. Memory: 8 bytes for each of
/// those, and for each square of 64 tiles a side.
class KeysOfTiles {
 public:
  explicit KeysOfTiles(const Floor::Tiles& tiles) : tiles_(tiles) {
    for (std::uint32_t row = tiles.first_row >> kLog2; row <= tiles.last_row >> kLog2; ++row) {
      for (std::uint32_t c = tiles.first_column >> kLog2; c <= tiles.last_column >> kLog2; ++c) {
        squares_.push_back(FloorShape::key(c << kLog2, row << kLog2) >> (2 * kLog2));
      }
    }
    std::sort(squares_.begin(), squares_.end());
  }
  /// The next ones; none when all were given.
  [[nodiscard]] const std::vector<std::uint64_t>& next() {
    keys_.clear();
    while (at_ < squares_.size() && keys_.size() < kTilesAtOnce) add_square(squares_[at_++]);
    return keys_;
  }

 private:
  static constexpr unsigned kLog2 = 6;
  static constexpr std::uint32_t kSide = 1U << kLog2;

  /// A square of tiles is a run of the curve.
  void add_square(std::uint64_t square) {
    const HilbertCell some = hilbert_cell(square << (2 * kLog2));
    const std::uint32_t low_x = some.x & ~(kSide - 1), low_y = some.y & ~(kSide - 1);
    const auto before = static_cast<std::ptrdiff_t>(keys_.size());
    for (std::uint32_t y = std::max(low_y, tiles_.first_row);
         y <= std::min(low_y + kSide - 1, tiles_.last_row); ++y) {
      for (std::uint32_t x = std::max(low_x, tiles_.first_column);
           x <= std::min(low_x + kSide - 1, tiles_.last_column); ++x) {
        keys_.push_back(FloorShape::key(x, y));
      }
    }
    std::sort(keys_.begin() + before, keys_.end());
  }

  Floor::Tiles tiles_;
  std::vector<std::uint64_t> squares_, keys_;
  std::size_t at_ = 0;
};

/// Of a far file the root comes together with the first nodes below it: in most files with all.
void announce_nodes(const ReadableFile& file, const FloorPlace& place) {
  constexpr std::uint64_t kMostBytes = 15 * layout::kNodeBytes;
  if (!file.is_far()) return;
  const std::array ranges{ByteRange{place.root, layout::kNodeBytes},
                          ByteRange{place.nodes.offset, std::min(place.nodes.bytes, kMostBytes)}};
  file.will_need(ranges);
}

/// Keys from one on that come before another.
std::span<const std::uint64_t> keys_between(std::span<const std::uint64_t> keys,
                                            std::uint64_t first, std::uint64_t end) {
  const auto begin = std::lower_bound(keys.begin(), keys.end(), first);
  return {begin, std::lower_bound(begin, keys.end(), end)};
}

}  // namespace

Floor::Floor(const ReadableFile& file, const FloorPlace& place, const StoreFacts& store)
    : file_(file), place_(place), numbers_(store.heights, 0.0) {
  announce_nodes(file_, place_);
  file_.read_at(std::as_writable_bytes(std::span(&root_, 1)), place_.root);
  if (checksum_of_object(root_) != place_.root_checksum) {
    damaged("the root above the heights does not match its checksum; the file is damaged");
  }
  std::uint64_t pages = 0;
  if (const char* const fault = take_facts(root_, store, facts_, pages)) damaged(fault);
  if (place_.pages.bytes / layout::kFloorPageBytes != pages) {
    damaged("the section of heights has not the length that its pages ask for");
  }
  tree_ = FloorTree(pages);
  if (place_.nodes.bytes / layout::kNodeBytes != tree_.total_nodes() - 1) {
    damaged("the nodes above the heights are not as many as their pages ask for");
  }
  numbers_ = FloorNumbers(store.heights, facts_.step);
  if (const char* const fault = fault_in(root_, tree_.children(0, 0))) damaged(fault);
}

void Floor::damaged(const char* what) const {
  throw Error(ErrorCode::corruption, what, file_.path());
}

layout::FloorNode Floor::read_node(std::size_t level, std::uint64_t number,
                                   std::uint64_t checksum) const {
  layout::FloorNode node{};
  file_.read_at(std::as_writable_bytes(std::span(&node, 1)),
                place_.offset_of_node(tree_.position(level, number)));
  if (checksum_of_object(node) != checksum) {
    damaged("a node above the heights does not match its checksum; the file is damaged");
  }
  if (const char* const fault = fault_in(node, tree_.children(level, number))) damaged(fault);
  return node;
}

layout::FloorNode Floor::node(std::size_t level, const Child& at, IoCounters& counters) const {
  const std::uint64_t position = tree_.position(level, at.number);
  Slot& slot = slots_[position % kSlots];
  ++counters.index_nodes;
  counters.bytes_read += layout::kNodeBytes;
  {
    const std::lock_guard lock(slot.lock);
    if (slot.position == position) return *slot.node;
  }
  const layout::FloorNode read = read_node(level, at.number, at.entry.checksum);
  file_.settle(counters);
  if (read.entry[0].first != at.entry.first || read.entry[read.entries - 1].first >= at.end) {
    damaged("the entries of a node above the heights are not those of its parent's keys");
  }
  const std::lock_guard lock(slot.lock);
  slot.position = UINT64_MAX;  // where there is no memory, it holds none
  if (slot.node == nullptr) slot.node = std::make_unique<layout::FloorNode>();
  *slot.node = read;
  slot.position = position;
  return read;
}

Floor::Child Floor::child_with(std::uint64_t key, const layout::FloorNode& node,
                               const Child& at) const {
  const auto end = node.entry.begin() + node.entries;
  const auto after =
      std::upper_bound(node.entry.begin(), end, key,
                       [](std::uint64_t k, const layout::FloorEntry& e) { return k < e.first; });
  if (after == node.entry.begin()) damaged("a tile of heights comes before all pages");
  return {
      at.number * layout::kFloorFanOut + static_cast<std::uint64_t>(after - 1 - node.entry.begin()),
      after != end ? after->first : at.end, *(after - 1)};
}

Floor::Child Floor::find(std::uint64_t key, Path& path, IoCounters& counters) const {
  while (!path.below.empty() &&
         (key < path.below.back().at.entry.first || key >= path.below.back().at.end)) {
    path.below.pop_back();
  }
  if (!path.is_begun) {
    path.is_begun = true;
    ++counters.index_nodes;
    counters.bytes_read += layout::kNodeBytes;
    path.below.reserve(tree_.levels() - 1);
  }
  for (;;) {
    const std::size_t level = path.below.size();
    const Child child = level == 0 ? child_with(key, root_, {0, UINT64_MAX, {}})
                                   : child_with(key, path.below.back().node, path.below.back().at);
    if (level + 1 == tree_.levels()) return child;
    path.below.push_back({child, node(level + 1, child, counters)});
  }
}

void Floor::read_page(const Child& found, Page& page, IoCounters& counters) const {
  if (page.number_ == found.number) return;
  page.number_ = UINT64_MAX;  // until it is verified
  page.bytes_.resize(layout::kFloorPageBytes + kFloorTileTail);
  const std::span<std::byte> bytes = std::span(page.bytes_).first(layout::kFloorPageBytes);
  file_.read_at(bytes, place_.offset_of_page(found.number));
  ++counters.pages;
  ++counters.pages_verified;
  counters.bytes_read += layout::kFloorPageBytes;
  if (checksum_of(bytes) != found.entry.checksum) {
    damaged("a page of heights does not match its checksum; the file is damaged");
  }
  if (const char* const fault = FloorPage(page.bytes_).fault()) damaged(fault);
  file_.settle(counters);
  page.number_ = found.number;
  page.first_ = found.entry.first;
  page.end_ = found.end;
}

/// Whether all heights are such as numbers of the file's type can be.
bool Floor::has_heights(const FloorTile& tile) const {
  const OrderedHeights all = numbers_.all();
  if (all.least == 0 && all.most == UINT32_MAX) return true;
  bool is_so = true;
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    const bool is_void = !tile.is_void.empty() && tile.is_void[i] != 0;
    is_so &= is_void || tile.heights[i] - all.least <= all.most - all.least;
  }
  return is_so && std::ranges::all_of(tile.lone, [&](const FloorTile::Lone& lone) {
           return lone.height - all.least <= all.most - all.least;
         });
}

void Floor::decode(const Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
                   FloorTile& tile) const {
  const FloorShape& shape = facts_.shape;
  const char* const fault =
      read_floor_tile(FloorPage(page.bytes_).bytes(i), shape.samples_of(column, shape.width),
                      shape.samples_of(row, shape.height), tile);
  if (fault != nullptr) damaged(fault);
  if (!has_heights(tile)) damaged("a tile of heights has a height that is no number");
}

void Floor::read(std::uint32_t column, std::uint32_t row, Page& page, FloorTile& tile,
                 IoCounters& counters) const {
  const std::uint64_t key = FloorShape::key(column, row);
  if (page.number_ == UINT64_MAX || key < page.first_ || key >= page.end_) {
    read_page(find(key, page.path_, counters), page, counters);
  }
  const std::optional<std::size_t> i = FloorPage(page.bytes_).find(key - page.first_);
  if (!i) damaged("a tile of heights is on no page");
  decode(page, *i, column, row, tile);
}

std::vector<Floor::Child> Floor::pages_of(std::span<const std::uint64_t> keys,
                                          const std::function<bool(const TileBounds&)>& wants,
                                          Path& path, IoCounters& counters) const {
  std::vector<Child> pages;
  RangesToCome ranges(file_, counters);
  RangeJoiner joiner(place_.pages.offset, layout::kFloorPageBytes, ranges);
  for (auto key = keys.begin(); key != keys.end();) {
    const Child found = find(*key, path, counters);
    const auto end = std::lower_bound(key, keys.end(), found.end);
    if (end == key) damaged("the pages of heights are not in order");
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

bool Floor::visit_page(const Page& page, std::span<const std::uint64_t> keys,
                       const std::function<bool(const TileBounds&)>& wants,
                       const std::function<bool(const TileBounds&, const FloorTile&)>& take,
                       FloorTile& tile) const {
  const FloorPage seen(page.bytes_);
  for (const std::uint64_t key : keys) {
    const std::optional<std::size_t> i = seen.find(key - page.first_);
    if (!i) damaged("a tile of heights is on no page");
    const HilbertCell cell = hilbert_cell(key);
    const FloorBounds heights = seen.bounds(*i);
    const TileBounds bounds{cell.x, cell.y, heights.least, heights.greatest};
    if (!wants(bounds)) continue;
    decode(page, *i, cell.x, cell.y, tile);
    if (!take(bounds, tile)) return false;
  }
  return true;
}

bool Floor::visit(const Tiles& tiles, const std::function<bool(const TileBounds&)>& wants,
                  const std::function<bool(const TileBounds&, const FloorTile&)>& take,
                  IoCounters& counters) const {
  Page page;
  FloorTile tile;
  KeysOfTiles all(tiles);
  for (std::span<const std::uint64_t> keys = all.next(); !keys.empty(); keys = all.next()) {
    for (const Child& found : pages_of(keys, wants, page.path_, counters)) {
      read_page(found, page, counters);
      const auto of_page = keys_between(keys, found.entry.first, found.end);
      if (!visit_page(page, of_page, wants, take, tile)) return false;
    }
  }
  return true;
}

}  // namespace ptin
