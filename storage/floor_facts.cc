// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/floor_facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ptin {

namespace {

constexpr std::uint8_t kGradient = 1;  ///< The coding of tiles (floor_tile.h).
constexpr std::uint16_t kIsExact = 1, kHasNodata = 2;
constexpr std::uint32_t kLeastSideLog2 = 4, kMostSideLog2 = 6;
static_assert((1U << kMostSideLog2) == kMostFloorSide);
/// With which the height of every number is finite.
constexpr double kMostStep = static_cast<double>(std::numeric_limits<float>::max()) / 0x1p31;

constexpr std::uint64_t kNaNBits = 0x7FF8000000000000U;  ///< The one form of a nodata of NaN.

template <class T>
Interval range_as() noexcept {
  return {static_cast<double>(std::numeric_limits<T>::lowest()),
          static_cast<double>(std::numeric_limits<T>::max())};
}

}  // namespace

Interval range_of(SourceNumber number) noexcept {
  switch (number) {
    case SourceNumber::kUInt8:
      return range_as<std::uint8_t>();
    case SourceNumber::kInt8:
      return range_as<std::int8_t>();
    case SourceNumber::kUInt16:
      return range_as<std::uint16_t>();
    case SourceNumber::kInt16:
      return range_as<std::int16_t>();
    case SourceNumber::kUInt32:
      return range_as<std::uint32_t>();
    case SourceNumber::kInt32:
      return range_as<std::int32_t>();
    case SourceNumber::kFloat32:
      return range_as<float>();
    case SourceNumber::kFloat64:
    case SourceNumber::kUnknown:
      break;
  }
  return range_as<double>();
}

void put_facts(const FloorFacts& facts, std::uint64_t pages, layout::FloorNode& root) noexcept {
  root.side_log2 = static_cast<std::uint8_t>(facts.shape.side_log2);
  root.coding = kGradient;
  root.flags =
      static_cast<std::uint16_t>((facts.is_exact ? kIsExact : 0) | (facts.nodata ? kHasNodata : 0));
  root.pages = pages;
  root.width = facts.shape.width;
  root.height = facts.shape.height;
  root.step = layout::to_bits(facts.step);
  const double nodata = facts.nodata.value_or(0.0);
  root.nodata = std::isnan(nodata) ? kNaNBits : layout::to_bits(nodata);
  root.source_type = static_cast<std::uint32_t>(facts.source);
}

const char* take_facts(const layout::FloorNode& root, const StoreFacts& store, FloorFacts& facts,
                       std::uint64_t& pages) noexcept {
  if (root.coding != kGradient) {
    return "the heights are coded in a way that this program does not know";
  }
  if (root.side_log2 < kLeastSideLog2 || root.side_log2 > kMostSideLog2) {
    return "the heights have tiles that no program makes";
  }
  if (store.bounds.min_x != 0 || store.bounds.min_y != 0 ||
      root.width != static_cast<std::uint32_t>(store.bounds.max_x) + 1 ||
      root.height != static_cast<std::uint32_t>(store.bounds.max_y) + 1) {
    return "the heights are of another raster: its samples are not the positions of the bounds";
  }
  facts.shape = {root.side_log2, root.width, root.height};
  facts.step = layout::to_double(root.step);
  if (!(facts.step >= 0.0 && facts.step <= kMostStep) || std::signbit(facts.step) ||
      (facts.step != 0.0 && store.heights.type != HeightType::float32)) {
    return "the heights have a step that no program writes";
  }
  if (root.source_type > static_cast<std::uint32_t>(SourceNumber::kFloat64)) {
    return "the heights are of a type that this program does not know";
  }
  facts.source = static_cast<SourceNumber>(root.source_type);
  facts.is_exact = (root.flags & kIsExact) != 0;
  if (facts.is_exact && (facts.source == SourceNumber::kUnknown ||
                         (are_codes(facts.source) && store.heights.type != HeightType::int32))) {
    return "the heights are said to be the source's numbers, and cannot be of its type";
  }
  const bool has_nodata = (root.flags & kHasNodata) != 0;
  const double nodata = layout::to_double(root.nodata);
  if ((root.flags & ~(kIsExact | kHasNodata)) != 0 || (!has_nodata && root.nodata != 0) ||
      (std::isnan(nodata) && root.nodata != kNaNBits) ||
      std::ranges::any_of(root.reserved, [](auto b) { return b != 0; })) {
    return "the root above the heights has flags or bytes that no program writes";
  }
  facts.nodata = has_nodata ? std::optional(nodata) : std::nullopt;
  pages = root.pages;
  // A page has a tile at least.
  if (pages > facts.shape.tiles() ||
      pages < (facts.shape.tiles() + layout::kMostFloorTiles - 1) / layout::kMostFloorTiles) {
    return "the heights have more pages than tiles, or fewer than hold these";
  }
  return nullptr;
}

}  // namespace ptin
