// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor.h"

#include <algorithm>
#include <optional>

#include "engine/error.h"
#include "storage/file/checksum.h"
#include "storage/floor_page.h"

namespace ptin {

Floor::Floor(const ReadableFile& file, const FloorPlace& place, const StoreFacts& store)
    : file_(file), place_(place), heights_(store.heights), numbers_(store.heights, 0.0) {
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
  if (root_.entry[0].first != 0) damaged("the first page of heights lacks the first tile");
}

void Floor::damaged(const char* what) const {
  throw Error(ErrorCode::corruption, what, file_.path());
}

layout::FloorNode Floor::read_node(const Found& found) const {
  layout::FloorNode node{};
  file_.read_at(std::as_writable_bytes(std::span(&node, 1)),
                place_.offset_of_node(tree_.position(found.level, found.number)));
  if (checksum_of_object(node) != found.entry.checksum) {
    damaged("a node above the heights does not match its checksum; the file is damaged");
  }
  const std::uint32_t entries = tree_.children(found.level, found.number);
  if (const char* const fault = fault_in(node, entries)) damaged(fault);
  if (node.entry[0].first != found.entry.first || node.entry[entries - 1].first >= found.end) {
    damaged("the entries of a node above the heights are not those of its parent's keys");
  }
  return node;
}

void Floor::take_node(const Found& found, layout::FloorNode& node, IoCounters& counters) const {
  const std::uint64_t position = tree_.position(found.level, found.number);
  Slot& slot = slots_[position % kSlots];
  {
    const std::lock_guard lock(slot.lock);
    if (slot.position == position) {
      node = *slot.node;
      return;
    }
  }
  node = read_node(found);
  file_.settle(counters);
  const std::lock_guard lock(slot.lock);
  slot.position = UINT64_MAX;  // where there is no memory, it holds none
  if (slot.node == nullptr) slot.node = std::make_unique<layout::FloorNode>();
  *slot.node = node;
  slot.position = position;
}

const layout::FloorNode& Floor::node(const Found& found, Recent& recent,
                                     IoCounters& counters) const {
  const std::uint64_t position = tree_.position(found.level, found.number);
  if (position == 0) return root_;
  Recent::Node& kept = recent.nodes_[position % recent.nodes_.size()];
  if (kept.position == position) return *kept.node;
  ++counters.index_nodes;
  counters.bytes_read += layout::kNodeBytes;
  kept.position = UINT64_MAX;  // until it is verified
  if (kept.node == nullptr) kept.node = std::make_unique<layout::FloorNode>();
  take_node(found, *kept.node, counters);
  kept.position = position;
  return *kept.node;
}

Floor::Found Floor::root() const noexcept {
  return {0, UINT64_MAX, {0, 0, 0, place_.root_checksum}, 0};
}

Floor::Found Floor::find(std::uint64_t key, std::size_t depth, Recent& recent,
                         IoCounters& counters) const {
  Found found = root();
  while (found.level < depth) {
    const layout::FloorNode& here = node(found, recent, counters);
    const auto end = here.entry.begin() + here.entries;
    const auto after =
        std::upper_bound(here.entry.begin(), end, key,
                         [](std::uint64_t k, const layout::FloorEntry& e) { return k < e.first; });
    found = {found.number * layout::kFloorFanOut +
                 static_cast<std::uint64_t>(after - 1 - here.entry.begin()),
             after != end ? after->first : found.end, *(after - 1), found.level + 1};
  }
  return found;
}

/// The nodes or pages of a depth that hold some keys.
std::vector<Floor::Found> Floor::find_all(std::span<const std::uint64_t> keys, std::size_t depth,
                                          Recent& recent, IoCounters& counters) const {
  std::vector<Found> found;
  for (auto key = keys.begin(); key != keys.end();) {
    found.push_back(find(*key, depth, recent, counters));
    key = std::lower_bound(key, keys.end(), found.back().end);
  }
  return found;
}

void Floor::announce(std::span<const std::uint64_t> keys, Recent& recent, IoCounters& counters,
                     Coming coming) const {
  if (!is_far()) return;
  for (std::size_t depth = 1; depth <= tree_.levels(); ++depth) {
    announce(find_all(keys, depth, recent, counters), recent, counters, coming);
  }
}

void Floor::announce_known(std::span<const std::uint64_t> keys, Recent& recent,
                           IoCounters& counters) const {
  if (!is_far()) return;
  for (std::size_t depth = 1; depth <= tree_.levels(); ++depth) {
    const std::vector<Found> found = find_all(keys, depth, recent, counters);
    announce(found, recent, counters, Coming::kWithNext);
    const auto is_known = [&](const Found& f) { return is_at_hand(f, recent); };
    if (depth < tree_.levels() && !std::ranges::all_of(found, is_known)) return;
  }
}

/// Whether a node is read without waiting for a server.
bool Floor::is_at_hand(const Found& node, const Recent& recent) const {
  const std::uint64_t position = tree_.position(node.level, node.number);
  return recent.nodes_[position % recent.nodes_.size()].position == position ||
         file_.is_at_hand({place_.offset_of_node(position), layout::kNodeBytes});
}

const Floor::Recent::Page& Floor::read_page(const Found& found, Recent& recent,
                                            IoCounters& counters) const {
  Recent::Page& page = recent.pages_[found.number % recent.pages_.size()];
  recent.last_ = &page;
  if (page.number == found.number) return page;
  page.number = UINT64_MAX;  // until it is verified
  page.bytes.resize(layout::kFloorPageBytes + kFloorTileTail);
  const std::span<std::byte> bytes = std::span(page.bytes).first(layout::kFloorPageBytes);
  file_.read_at(bytes, place_.offset_of_page(found.number));
  ++counters.pages;
  ++counters.pages_verified;
  counters.bytes_read += layout::kFloorPageBytes;
  if (checksum_of(bytes) != found.entry.checksum) {
    damaged("a page of heights does not match its checksum; the file is damaged");
  }
  const FloorPageView view(bytes);
  if (const char* const fault = view.fault()) damaged(fault);
  if (view.key(view.tiles() - 1) >= found.end - found.entry.first) {
    damaged("a page of heights has tiles of the next one");
  }
  file_.settle(counters);
  page.number = found.number;
  page.first = found.entry.first;
  page.end = found.end;
  return page;
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

void Floor::decode(const Recent::Page& page, std::size_t i, std::uint32_t column, std::uint32_t row,
                   FloorTile& tile) const {
  const FloorShape& shape = facts_.shape;
  const char* const fault =
      read_floor_tile(page.view().tile(i), shape.samples_of(column, shape.width),
                      shape.samples_of(row, shape.height), tile);
  if (fault != nullptr) damaged(fault);
  if (!has_heights(tile)) damaged("a tile of heights has a height that is no number");
}

void Floor::read(std::uint32_t column, std::uint32_t row, Recent& recent, FloorTile& tile,
                 IoCounters& counters) const {
  const std::uint64_t key = FloorShape::key(column, row);
  const Recent::Page* page = recent.last_;
  if (page->number == UINT64_MAX || key < page->first || key >= page->end) {
    page = &read_page(find(key, tree_.levels(), recent, counters), recent, counters);
  }
  const std::optional<std::size_t> i = page->view().tile_with(key - page->first);
  if (!i) damaged("a tile of heights is on no page");
  decode(*page, *i, column, row, tile);
}

}  // namespace ptin
