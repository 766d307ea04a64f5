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

#include "engine/geometry/box.h"
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
  kShift,       ///< Binary logarithm of the unit of kBelow and kAbove.
};
inline constexpr std::size_t kPageColumns = 18;

/// The form of a file's pages.
struct PageForm {
  std::uint16_t major_version = layout::kMajorVersion;
  /// The file has the heights of a raster, and a page of which all vertices lie near one another
  /// leaves theirs to these.
  bool has_floor = false;
  /// Since version 3 records descend by error, intervals of heights lie on nested grids, and a page
  /// may be local.
  [[nodiscard]] constexpr bool is_plain() const noexcept { return major_version == 2; }
};

/// Whether vertices within a box are near enough for a page to leave their heights to the raster's
/// tiles: the box meets at most 9 squares of 32 x 32 cells.
[[nodiscard]] constexpr bool is_local_box(const GridBox& box) noexcept {
  constexpr std::int64_t kMostSquares = 9;
  constexpr int kSquareLog2 = 5;
  const std::int64_t along_x = (box.max_x >> kSquareLog2) - (box.min_x >> kSquareLog2) + 1;
  const std::int64_t along_y = (box.max_y >> kSquareLog2) - (box.min_y >> kSquareLog2) + 1;
  return along_x <= kMostSquares && along_y <= kMostSquares && along_x * along_y <= kMostSquares;
}

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
    31, 31, 32, 31, 31, 31, 31, 32, 32, kMostShortWidth, kMostShortWidth, 16, 4, 8, 5, 6, 4, 5};
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

/// The height of u, and the ends of the record's interval, as ordered numbers without wrap-around.
struct OrderedInterval {
  std::uint64_t height, low, high;
};

/// An interval of heights as pages keep it, around the height of u.
struct KeptInterval {
  std::uint32_t shift, below, above;
};

/// The most that a shift may be.
inline constexpr std::uint32_t kMostShift = 31;
/// How many units of 2^shift an interval takes at most: the more, the nearer its ends stay.
inline constexpr std::uint64_t kMostIntervalUnits = 16;

/// Rounds an interval outward to the least unit of which it takes at most kMostIntervalUnits. Units
/// are powers of two from 0 on, and that of an interval is none of a smaller one's: so an interval
/// that holds another one still does, and rounding again changes nothing.
/// REQUIRES: low <= height <= high.
[[nodiscard]] constexpr KeptInterval kept_interval(const OrderedInterval& h) noexcept {
  std::uint32_t shift = 0;
  while ((h.high >> shift) - (h.low >> shift) >= kMostIntervalUnits) {
    ++shift;
  }
  return {shift, static_cast<std::uint32_t>((h.height >> shift) - (h.low >> shift)),
          static_cast<std::uint32_t>((h.high >> shift) - (h.height >> shift))};
}

/// The interval that is kept. Of any numbers: an end that no height has lies beyond 32 bits.
[[nodiscard]] constexpr OrderedInterval interval_of(std::uint64_t height, std::uint64_t shift,
                                                    std::uint64_t below, std::uint64_t above,
                                                    HeightType type) noexcept {
  const std::uint64_t unit = height >> shift;
  OrderedInterval h{height, (unit - below) << shift, ((unit + 1 + above) << shift) - 1};
  if (shift != 0 && type == HeightType::float32) {
    // Beyond the infinities there are no floats, and of the two zeros 0 is written.
    const OrderedHeights all = ordered_heights(type);
    if (h.low < all.least && below <= unit) h.low = all.least;
    if (h.high > all.most && h.high <= UINT32_MAX) h.high = all.most;
    constexpr std::uint64_t kZero = 0x80000000U;
    if (h.high == kZero - 1) h.high = kZero;
  }
  return h;
}

/// The frame of a page, as its header gives it.
class PageColumns {
 public:
  /// @param page  Checked: widths are none that a number does not need, and all that follows from
  ///     header and widths lies within the page.
  /// @return Whether it is sound; else nothing may be asked.
  [[nodiscard]] bool read(std::span<const std::byte> page, const PageForm& form) noexcept;

  [[nodiscard]] std::uint32_t records() const noexcept { return header_.records; }
  /// Whether kHeight and the heights of corners are those of the raster's samples, and not here.
  [[nodiscard]] bool is_local() const noexcept { return (header_.flags & layout::kLocalPage) != 0; }
  /// Whether kError is read by read_errors(), as bits of short numbers.
  [[nodiscard]] bool has_descending_errors() const noexcept { return descends_; }
  /// The number of a column, without wrap-around. REQUIRES: i < records(); the column lies here.
  [[nodiscard]] std::uint64_t at(const std::byte* page, PageColumn column,
                                 std::size_t i) const noexcept {
    const auto c = static_cast<std::size_t>(column);
    const unsigned width = width_[c];
    return base_[c] + read_bits(page, begin_[c] + i * width, width);
  }
  /// The numbers of a column for records from `first` on. REQUIRES: first + out.size() <= records().
  void read_run(const std::byte* page, PageColumn column, std::size_t first,
                std::span<std::uint64_t> out) const noexcept;
  /// Bits of the errors of a run of layout::kErrorRun records or fewer; kNoShort of those that
  /// cannot be what was written. REQUIRES: `first` begins such a run.
  void read_errors(const std::byte* page, std::size_t first,
                   std::span<std::uint64_t> out) const noexcept;
  static constexpr std::uint64_t kNoShort = UINT16_MAX;

  [[nodiscard]] unsigned width(PageColumn column) const noexcept {
    return width_[static_cast<std::size_t>(column)];
  }
  /// Bits that each corner takes besides offset and height.
  [[nodiscard]] unsigned common_bits() const noexcept { return common_bits_; }
  [[nodiscard]] const layout::PageHeader& header() const noexcept { return header_; }
  /// First bit of the ring of a run's first record, in the page.
  [[nodiscard]] std::size_t run_begin(const std::byte* page, std::size_t run) const noexcept {
    return (rings_ + place(page, runs_, run)) * 8;
  }
  /// The bit behind all rings.
  [[nodiscard]] std::size_t rings_end() const noexcept { return (rings_ + header_.ring_bytes) * 8; }

 private:
  [[nodiscard]] static std::uint16_t place(const std::byte* page, std::size_t places,
                                           std::size_t i) noexcept {
    std::uint16_t place;
    std::memcpy(&place, page + places + i * sizeof place, sizeof place);
    return place;
  }
  [[nodiscard]] bool read_errors_frame(std::span<const std::byte> page) noexcept;

  layout::PageHeader header_;
  std::array<std::uint8_t, kPageColumns> width_;
  std::array<std::uint32_t, kPageColumns> base_;
  std::array<std::uint32_t, kPageColumns> begin_;  ///< First bit of the column.
  unsigned common_bits_ = 0;
  bool descends_ = false;
  std::size_t runs_ = 0;          ///< Where the places of runs lie, in bytes.
  std::size_t error_runs_ = 0;    ///< Those of runs of errors.
  std::size_t error_places_ = 0;  ///< Where the bits lie that tell the upper parts of errors.
  std::size_t rings_ = 0;         ///< Where the rings lie.
};

/// How errors that descend are written: the difference of each from the first, its lower `low_bits`
/// as a number of the column, and the upper part by the place of a bit that is set, which is the
/// sum of that part and of the record's number (P. Elias, Efficient storage and retrieval by
/// content and address of static files, 1974).
struct ErrorsCode {
  unsigned low_bits;       ///< The number with which all take fewest bits, the least of these.
  std::size_t place_bits;  ///< Bits for the upper parts.
};
[[nodiscard]] ErrorsCode code_of_errors(std::uint32_t range, std::size_t records) noexcept;

/// Bytes of the places of runs, and before the first ring, for so many records.
[[nodiscard]] std::size_t error_place_bytes(std::size_t records, std::size_t place_bits) noexcept;

/// Bytes of the columns and of the places of runs, for so many records.
[[nodiscard]] std::size_t column_bytes(const std::array<std::uint8_t, kPageColumns>& width,
                                       std::size_t records) noexcept;

/// The widths of all columns.
[[nodiscard]] std::array<std::uint8_t, kPageColumns> widths_of(
    const layout::PageHeader& header) noexcept;

/// The bases of all columns; 0 where a column has none, or one of its own.
[[nodiscard]] std::array<std::uint32_t, kPageColumns> bases_of(
    const layout::PageHeader& header) noexcept;

}  // namespace ptin
