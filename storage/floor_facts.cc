// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor_facts.h"

#include <bit>

namespace ptin {

namespace {

constexpr std::uint8_t kGradient = 1;  ///< The coding of tiles (floor_tile.h).
constexpr std::uint16_t kIsExact = 1, kHasNodata = 2;
constexpr std::uint32_t kLeastSideLog2 = 4, kMostSideLog2 = 6;
static_assert((1U << kMostSideLog2) == kMostFloorSide);

}  // namespace

void put_facts(const FloorFacts& facts, std::uint64_t pages, layout::FloorNode& root) noexcept {
  root.side_log2 = static_cast<std::uint8_t>(facts.shape.side_log2);
  root.coding = kGradient;
  root.flags =
      static_cast<std::uint16_t>((facts.is_exact ? kIsExact : 0) | (facts.nodata ? kHasNodata : 0));
  root.pages = pages;
  root.width = facts.shape.width;
  root.height = facts.shape.height;
  root.step = layout::to_bits(facts.step);
  root.nodata = layout::to_bits(facts.nodata.value_or(0.0));
  root.source_type = static_cast<std::uint32_t>(facts.source);
}

const char* take_facts(const layout::FloorNode& root, FloorFacts& facts,
                       std::uint64_t& pages) noexcept {
  facts.shape = {root.side_log2, root.width, root.height};
  if (root.coding != kGradient)
    return "the heights are coded in a way that this program does not know";
  if (root.side_log2 < kLeastSideLog2 || root.side_log2 > kMostSideLog2 || root.width == 0 ||
      root.height == 0) {
    return "the heights have tiles that no program makes";
  }
  facts.step = layout::to_double(root.step);
  if (!(facts.step >= 0.0) || !std::isfinite(facts.step)) return "the heights have a step below 0";
  if (root.source_type > static_cast<std::uint32_t>(SourceNumber::kFloat64)) {
    return "the heights are of a type that this program does not know";
  }
  facts.source = static_cast<SourceNumber>(root.source_type);
  facts.is_exact = (root.flags & kIsExact) != 0;
  facts.nodata.reset();
  if ((root.flags & kHasNodata) != 0) facts.nodata = layout::to_double(root.nodata);
  pages = root.pages;
  // A page has a tile at least.
  if (pages == 0 || pages > facts.shape.tiles()) return "the heights have too many pages, or none";
  return nullptr;
}

}  // namespace ptin
