// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the numbers of a page lie: columns of fixed width above a base, then the rings
// (storage/FORMAT.md, "Pages"; the technique is known as frame of reference).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/geometry/height.h"
#include "storage/bit_fields.h"
#include "storage/layout.h"

namespace ptin {

/// The columns of a page, in the order of the file: a number for each record.
enum class PageColumn : std::uint8_t {
  kX,
  kY,       ///< Position of u.
  kHeight,  ///< Ordered height of u; where u has none, the least of its interval.
  kWest,    ///< From u to the roi's sides.
  kSouth,
  kEast,
  kNorth,
  kBelow,  ///< From kHeight to the ends of the interval of heights.
  kAbove,
  kError,  ///< As stored_short() has it, above a base of its own (storage/short_float.h).
  kDeviation,
  kRank,
  kFlags,       ///< PageFlag.
  kDegree,      ///< Corners of the ring.
  kOffsetBits,  ///< Width of a corner's offset from u, for x and y each.
  kHeightBits,  ///< Width of a corner's height above u's.
  kDeathBits,   ///< Width of a triangle's death.
};
inline constexpr std::size_t kPageColumns = 17;

enum PageFlag : std::uint8_t {
  kPageNoLeft = 1,      ///< VertexSplit::kNoLeft.
  kPageNoRight = 2,     ///< VertexSplit::kNoRight.
  kPageVertexVoid = 4,  ///< VertexSplit::kVertexVoid.
  kPageNoHeights = 8,   ///< The interval of heights is empty.
};

/// The most bits that a short number takes in a column, or a death in a ring.
inline constexpr std::uint8_t kMostShortWidth = 15;
/// The most bits that a number of each column takes.
inline constexpr std::array<std::uint8_t, kPageColumns> kMostColumnBits = {
    31, 31, 32, 31, 31, 31, 31, 32, 32, kMostShortWidth, kMostShortWidth, 16, 4, 8, 5, 6, 4};
/// The most bits of a corner's offset: the difference of two coordinates, with its sign.
inline constexpr std::uint8_t kMostOffsetWidth = 32;
/// The most bits of a corner's height: the difference of two ordered heights, with its sign.
inline constexpr std::uint8_t kMostHeightWidth = 33;

inline constexpr std::uint8_t kLeastDegree = 3;

/// Whether a ring of so many corners, with fields of these widths, can be what was written.
[[nodiscard]] constexpr bool is_ring_shape(std::uint64_t degree, std::uint64_t offset_bits,
                                           std::uint64_t height_bits,
                                           std::uint64_t death_bits) noexcept {
  return degree >= kLeastDegree && degree <= layout::kMostDegree &&
         offset_bits <= kMostOffsetWidth && height_bits <= kMostHeightWidth &&
         death_bits <= kMostShortWidth;
}

/// A height as a number whose order is that of heights, -0 and 0 being one.
[[nodiscard]] constexpr std::uint32_t ordered_height(HeightBits bits, HeightType type) noexcept {
  constexpr std::uint32_t kSign = 0x80000000U;
  if (type == HeightType::int32) {
    return bits ^ kSign;
  }
  return bits == kSign ? kSign : ((bits & kSign) != 0 ? ~bits : bits | kSign);
}
[[nodiscard]] constexpr HeightBits height_of_ordered(std::uint32_t ordered,
                                                     HeightType type) noexcept {
  constexpr std::uint32_t kSign = 0x80000000U;
  if (type == HeightType::int32) {
    return ordered ^ kSign;
  }
  return (ordered & kSign) != 0 ? ordered ^ kSign : ~ordered;
}

/// The least and the greatest ordered height; of floats those of the infinities, since a NaN is none.
struct OrderedHeights {
  std::uint32_t least, most;
};
[[nodiscard]] constexpr OrderedHeights ordered_heights(HeightType type) noexcept {
  return type == HeightType::int32 ? OrderedHeights{0, UINT32_MAX}
                                   : OrderedHeights{0x007FFFFF, 0xFF800000};
}

/// The frame of a page, as its header gives it.
class PageColumns {
 public:
  /// @param header  Checked: widths are none that a number does not need, and all that follows from
  ///     header and widths lies within the page.
  /// @return Whether it is sound; else nothing may be asked.
  [[nodiscard]] bool read(const layout::PageHeader& header, std::size_t page_bytes) noexcept;

  [[nodiscard]] std::uint32_t records() const noexcept { return header_.records; }
  /// The number of a column, without wrap-around. REQUIRES: i < records().
  [[nodiscard]] std::uint64_t at(const std::byte* page, PageColumn column,
                                 std::size_t i) const noexcept {
    const auto c = static_cast<std::size_t>(column);
    const unsigned width = header_.width[c];
    return base_[c] + read_bits(page, begin_[c] + i * width, width);
  }
  /// The numbers of a column for records from `first` on. REQUIRES: first + out.size() <= records().
  void read_run(const std::byte* page, PageColumn column, std::size_t first,
                std::span<std::uint64_t> out) const noexcept;
  /// Bits that each corner takes besides offset and height.
  [[nodiscard]] unsigned common_bits() const noexcept { return common_bits_; }
  [[nodiscard]] const layout::PageHeader& header() const noexcept { return header_; }
  /// First bit of the ring of a run's first record, in the page.
  [[nodiscard]] std::size_t run_begin(const std::byte* page, std::size_t run) const noexcept {
    std::uint16_t bytes;
    std::memcpy(&bytes, page + runs_ + run * sizeof bytes, sizeof bytes);
    return (rings_ + bytes) * 8;
  }
  /// The bit behind all rings.
  [[nodiscard]] std::size_t rings_end() const noexcept { return (rings_ + header_.ring_bytes) * 8; }

 private:
  layout::PageHeader header_;
  std::array<std::uint32_t, kPageColumns> base_;
  std::array<std::uint32_t, kPageColumns> begin_;  ///< First bit of the column.
  unsigned common_bits_ = 0;
  std::size_t runs_ = 0;   ///< Where the places of runs lie, in bytes.
  std::size_t rings_ = 0;  ///< Where the rings lie.
};

/// Bytes of the columns and of the places of runs, for so many records.
[[nodiscard]] std::size_t column_bytes(const std::array<std::uint8_t, kPageColumns>& width,
                                       std::size_t records) noexcept;

/// The bases of all columns; 0 where a column has none, or one of its own.
[[nodiscard]] std::array<std::uint32_t, kPageColumns> bases_of(
    const layout::PageHeader& header) noexcept;

}  // namespace ptin
