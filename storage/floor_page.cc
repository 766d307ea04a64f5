// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor_page.h"

namespace ptin {

const char* fault_in(const layout::FloorNode& node, std::uint32_t entries) noexcept {
  if (node.entries != entries) {
    return "a node above the heights has another number of entries than follows from its place";
  }
  for (std::uint32_t i = 1; i < entries; ++i) {
    if (node.entry[i].first <= node.entry[i - 1].first) {
      return "the entries of a node above the heights are not in order";
    }
  }
  return nullptr;
}

const char* FloorPageView::fault() const noexcept {
  if (head_.tiles == 0 || tiles_begin() > page_.size() || head_.bytes > page_.size()) {
    return "a page of heights has more tiles than fit, or none";
  }
  if (head_.span > UINT32_MAX - head_.least) {
    return "a page of heights has heights of more than 32 bits";
  }
  std::size_t end = tiles_begin();
  for (std::size_t i = 0; i < head_.tiles; ++i) {
    const bool is_next = i == 0 ? key(0) == 0 : key(i) > key(i - 1);
    if (!is_next || entry(i).end < end) return "the tiles of a page of heights are not in order";
    end = entry(i).end;
  }
  return end == head_.bytes ? nullptr : "the tiles of a page of heights do not end where it does";
}

std::optional<std::size_t> FloorPageView::tile_with(std::uint64_t wanted) const noexcept {
  std::size_t low = 0, high = head_.tiles;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const std::uint64_t there = key(middle);
    if (there == wanted) return middle;
    (there < wanted ? low : high) = there < wanted ? middle + 1 : middle;
  }
  return std::nullopt;
}

FloorBounds FloorPageView::heights(std::size_t i) const noexcept {
  const layout::FloorTileEntry of = entry(i);
  if (of.least > of.greatest) return {};
  const std::uint64_t span = head_.span;
  const std::uint64_t low = of.least * span / UINT16_MAX;
  const std::uint64_t high = (of.greatest * span + UINT16_MAX - 1) / UINT16_MAX;
  return {head_.least + static_cast<OrderedHeight>(low),
          head_.least + static_cast<OrderedHeight>(high)};
}

}  // namespace ptin
