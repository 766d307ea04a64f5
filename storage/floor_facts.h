// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is told of a raster whose heights are in the file, and how its heights are numbers of tiles.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "engine/geometry/height.h"
#include "engine/geometry/interval.h"
#include "storage/floor_shape.h"
#include "storage/floor_tile.h"
#include "storage/page_columns.h"
#include "storage/store_facts.h"

namespace ptin {

/// How the source holds its numbers; the values are those of the format.
enum class SourceNumber : std::uint32_t {
  kUnknown = 0,
  kUInt8 = 1,
  kInt8 = 2,
  kUInt16 = 3,
  kInt16 = 4,
  kUInt32 = 5,
  kInt32 = 6,
  kFloat32 = 7,
  kFloat64 = 8,
};

/// Whether the source's numbers are codes, of which heights are made by step and offset: those of integers that fit 32
/// bits with a sign. Of all others they are heights.
[[nodiscard]] constexpr bool are_codes(SourceNumber number) noexcept {
  return number != SourceNumber::kUnknown && number <= SourceNumber::kInt32 &&
         number != SourceNumber::kUInt32;
}
/// The least and the greatest number of a type; of an unknown one those of float64.
[[nodiscard]] Interval range_of(SourceNumber number) noexcept;

struct FloorFacts {
  FloorShape shape;
  /// Of heights that are stored as float32: each is float(step * k), and tiles hold k. 0: they hold the
  /// floats in their order. Of int32 it is 0, and tiles hold the codes.
  double step = 0.0;
  SourceNumber source = SourceNumber::kUnknown;
  /// The nodata value in force, which may be NaN. Void samples of an exact source have it, or where there
  /// is none the usual NaN.
  std::optional<double> nodata;
  /// The source's numbers come back bit for bit: those of integers of at most 32 bits with a sign are
  /// codes, all others heights.
  bool is_exact = false;
};

/// Heights as tiles hold them, and as stored elsewhere in the file.
class FloorNumbers {
 public:
  FloorNumbers(const HeightEncoding& heights, double step) noexcept
      : type_(heights.type), step_(step) {}

  [[nodiscard]] HeightBits bits(OrderedHeight ordered) const noexcept {
    if (step_ == 0) return height_of_ordered(ordered, type_);
    const double k = std::bit_cast<std::int32_t>(ordered ^ kSign);
    return std::bit_cast<HeightBits>(static_cast<float>(step_ * k));
  }
  /// Makes numbers of tiles what the file's vertices have as their ordered heights.
  void to_ordered_heights(std::span<OrderedHeight> numbers) const noexcept {
    if (step_ == 0) return;  // they are these
    for (OrderedHeight& number : numbers) number = ordered_height(bits(number), type_);
  }
  /// REQUIRES: with a step, the height is that of a whole number.
  [[nodiscard]] OrderedHeight ordered(HeightBits bits) const noexcept {
    if (step_ == 0) return ordered_height(bits, type_);
    const double k = std::nearbyint(std::bit_cast<float>(bits) / step_);
    return std::bit_cast<std::uint32_t>(static_cast<std::int32_t>(k)) ^ kSign;
  }
  /// The least and the greatest number whose height is one.
  [[nodiscard]] OrderedHeights all() const noexcept {
    if (step_ != 0 || type_ == HeightType::int32) return {0, UINT32_MAX};
    return {ordered_height(std::bit_cast<HeightBits>(-std::numeric_limits<float>::max()), type_),
            ordered_height(std::bit_cast<HeightBits>(std::numeric_limits<float>::max()), type_)};
  }
  /// Whether it is the number that ordered() gives of its height: of those with one height one is
  /// written. REQUIRES: within all().
  [[nodiscard]] bool is_written(OrderedHeight number) const noexcept {
    if (step_ != 0) {
      const double k = std::nearbyint(std::bit_cast<float>(bits(number)) / step_);
      return k == std::bit_cast<std::int32_t>(number ^ kSign);
    }
    return ordered_height(height_of_ordered(number, type_), type_) == number;
  }

 private:
  static constexpr std::uint32_t kSign = 0x80000000U;
  HeightType type_;
  double step_;
};

/// Puts facts into the root above the pages.
void put_facts(const FloorFacts& facts, std::uint64_t pages, layout::FloorNode& root) noexcept;
/// @param store  What the file says of its terrain.
/// @return What is wrong with the root, as a sentence; null where nothing is. Then numbers of any tiles
///         of so many pages lie within their types, and 453 tiles have a page at least.
[[nodiscard]] const char* take_facts(const layout::FloorNode& root, const StoreFacts& store,
                                     FloorFacts& facts, std::uint64_t& pages) noexcept;

}  // namespace ptin
