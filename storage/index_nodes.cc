// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/index_nodes.h"

#include <cstring>
#include <span>

#include "engine/error.h"
#include "storage/descriptor.h"
#include "storage/file/checksum.h"

namespace ptin {

namespace {

std::string node_name(const std::string& path, std::uint32_t level, std::uint64_t number) {
  return path + ", index level " + std::to_string(level) + ", node " + std::to_string(number);
}

}  // namespace

void IndexNodes::require_page(PageId page) const {
  const std::uint64_t pages = place_.shape.children(0);
  if (index_of(page) >= pages) [[unlikely]] {
    throw Error(ErrorCode::corruption,
                "page " + std::to_string(index_of(page)) + " was asked for, and there are " +
                    std::to_string(pages),
                path());
  }
}

void IndexNodes::verify(const layout::IndexNode& node, std::uint32_t level, std::uint64_t number,
                        std::uint64_t expected) const {
  if (checksum_of_object(node) != expected) {
    throw Error(ErrorCode::corruption,
                "the node does not match the checksum that its parent holds; the file is damaged",
                node_name(path(), level, number));
  }
  if (node.level != level || node.number != place_.shape.name_of(level, number) ||
      node.entries != place_.shape.entries(level, number)) {
    throw Error(ErrorCode::corruption,
                "the node says another place or number of entries than follows from its position",
                node_name(path(), level, number));
  }
  for (std::uint32_t i = 0; i < node.entries; ++i) {
    if (!is_sound(node.entry[i], heights_)) {
      throw Error(
          ErrorCode::corruption,
          "entry " + std::to_string(i) + " has a box, heights or errors that no program wrote",
          node_name(path(), level, number));
    }
  }
}

layout::NodeEntry IndexNodes::descend_to(PageId page) const {
  const auto [leaf, entry_in_leaf] = place_.shape.leaf_entry(index_of(page));
  // Number of the node of each level on the way: the leaf's, divided by the fan-out once a level.
  std::array<std::uint64_t, IndexShape::kMaxLevels> way{leaf};
  const std::uint32_t levels = place_.shape.levels();
  for (std::uint32_t level = 1; level < levels; ++level) {
    way[level] = way[level - 1] / layout::kFanOut;
  }
  layout::NodeEntry entry{};
  entry.checksum = place_.root_checksum;
  layout::IndexNode scratch;
  for (std::uint32_t level = levels; level-- > 0;) {
    const layout::IndexNode& n = node(level, way[level], entry.checksum, scratch);
    entry = n.entry[level == 0 ? entry_in_leaf : way[level - 1] % layout::kFanOut];
  }
  return entry;
}

void IndexNodes::add_ranges(std::uint32_t level, std::span<const std::uint64_t> numbers,
                            RangesToCome& ranges) const noexcept {
  RangeJoiner joiner(place_.offset, layout::kNodeBytes, ranges);
  for (const std::uint64_t number : numbers) {
    const std::uint64_t position = place_.shape.position(level, number);
    if (!is_known(position)) {
      joiner.add(position);
    }
  }
}

MappedIndexNodes::MappedIndexNodes(const ReadableFile& file, const MappedFile& mapping,
                                   const Root& place, const HeightEncoding& heights)
    : IndexNodes(file, place, heights), mapping_(mapping), verified_(place.shape.total_nodes()) {}

const layout::IndexNode& MappedIndexNodes::node(std::uint32_t level, std::uint64_t number,
                                                std::uint64_t expected, layout::IndexNode&) const {
  const std::uint64_t position = place_.shape.position(level, number);
  // Plain bytes at an address that is a multiple of 4096: what the file holds is the node.
  const auto& mapped =
      *reinterpret_cast<const layout::IndexNode*>(mapping_.at(offset_of(position)));
  if (!verified_.test(position)) {
    verify(mapped, level, number, expected);
    mapping_.require_undamaged();
    verified_.set(position);
  }
  return mapped;
}

layout::NodeEntry MappedIndexNodes::descriptor(PageId page) const {
  require_page(page);
  const auto [leaf, entry] = place_.shape.leaf_entry(index_of(page));
  const std::uint64_t position = place_.shape.position(0, leaf);
  if (!verified_.test(position)) {
    return descend_to(page);
  }
  const auto& mapped =
      *reinterpret_cast<const layout::IndexNode*>(mapping_.at(offset_of(position)));
  return mapped.entry[entry];
}

PreadIndexNodes::PreadIndexNodes(const ReadableFile& file, const Root& place,
                                 const HeightEncoding& heights)
    : IndexNodes(file, place, heights) {}

const layout::IndexNode& PreadIndexNodes::node(std::uint32_t level, std::uint64_t number,
                                               std::uint64_t expected,
                                               layout::IndexNode& scratch) const {
  const std::uint64_t position = place_.shape.position(level, number);
  Slot& slot = slot_of(position);
  {
    const std::lock_guard lock(slot.lock);
    if (slot.position == position) {
      scratch = *slot.node;
      return scratch;
    }
  }
  file_.read_at(std::as_writable_bytes(std::span(&scratch, 1)), offset_of(position));
  verify(scratch, level, number, expected);
  const std::lock_guard lock(slot.lock);
  if (!slot.node) {
    slot.node = std::make_unique<layout::IndexNode>();
  }
  *slot.node = scratch;
  slot.position = position;
  return scratch;
}

bool PreadIndexNodes::is_known(std::uint64_t position) const noexcept {
  Slot& slot = slot_of(position);
  const std::lock_guard lock(slot.lock);
  return slot.position == position;
}

layout::NodeEntry PreadIndexNodes::descriptor(PageId page) const {
  require_page(page);
  const auto [leaf, entry] = place_.shape.leaf_entry(index_of(page));
  const std::uint64_t position = place_.shape.position(0, leaf);
  Slot& slot = slot_of(position);
  {
    const std::lock_guard lock(slot.lock);
    if (slot.position == position) {
      return slot.node->entry[entry];
    }
  }
  return descend_to(page);
}

}  // namespace ptin
