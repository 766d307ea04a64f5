// SPDX-License-Identifier: GPL-3.0-or-later
//
// The numbers of one page of records and stars, taken out of its bytes (storage/FORMAT.md, "Pages").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/attributes.h"
#include "storage/page_columns.h"
#include "storage/short_float.h"
#include "storage/star.h"

namespace ptin {

/// How the corners of a ring are laid out.
struct RingShape {
  unsigned degree = 0, offset_bits = 0, height_bits = 0, death_bits = 0, corner_bits = 0;
  [[nodiscard]] std::size_t bits() const noexcept { return std::size_t{degree} * corner_bits; }
};

/// A ring of a page, from which the next ones are found without a look at those before it.
struct RingPlace {
  std::size_t record = SIZE_MAX;  ///< None yet.
  std::size_t bit = 0;            ///< Where it begins in the page.
  RingShape shape;
  bool is_sound = false;  ///< It lies where rings lie.
};

/// What the corners of a ring, and its triangles, span.
struct RingSpan {
  std::int64_t min_x = INT64_MAX, min_y = INT64_MAX;  ///< Of the corners, grid units.
  std::int64_t max_x = INT64_MIN, max_y = INT64_MIN;
  std::uint32_t low = UINT32_MAX, high = 0;  ///< Ordered heights; low > high: no corner has one.
  std::uint32_t least_death = UINT32_MAX;    ///< As death_bits().
};

/// The numbers of a page. Any bytes are safe to ask: an answer of false means that a field cannot
/// be what was written, and then what was asked for is unspecified.
class RecordPage {
 public:
  /// @param bytes  Borrowed, of a whole page.
  RecordPage(std::span<const std::byte> bytes, const HeightEncoding& heights) noexcept;

  /// Whether the header of the page can be what was written. REQUIRED by all that follows.
  [[nodiscard]] bool is_sound() const noexcept { return is_sound_; }
  [[nodiscard]] std::uint32_t records() const noexcept { return columns_.records(); }
  [[nodiscard]] const PageColumns& columns() const noexcept { return columns_; }
  [[nodiscard]] const std::byte* bytes() const noexcept { return bytes_.data(); }

  /// The roi of a record. Nothing is checked. REQUIRES, as all that follows: i < records().
  [[nodiscard]] GridBox roi(std::size_t i) const noexcept;
  /// The bits of a short number (storage/short_float.h), or more than those of infinity.
  [[nodiscard]] std::uint32_t error_bits(std::size_t i) const noexcept {
    return short_of_stored(number(PageColumn::kError, i), columns_.header().error);
  }
  /// Most records of a run.
  static constexpr std::uint32_t kRun = 64;
  /// The numbers of records one behind the other, taken out of the page column by column: a number
  /// takes a load and a shift for some of them then, and nothing is looked up between.
  struct RecordRun {
    std::uint32_t first = 0, count = 0;
    std::array<std::array<std::uint64_t, kRun>, kPageColumns> numbers;
  };
  /// Takes so many records from `first` on. REQUIRES: count <= kRun, first + count <= records().
  void read_run(std::uint32_t first, std::uint32_t count, RecordRun& run) const noexcept;
  /// The attributes of record `first` + k of a run. Nothing is checked: of a record that is not sound
  /// they may be anything. REQUIRES, as below: k < run.count.
  [[nodiscard]] Attributes attributes(const RecordRun& run, std::uint32_t k) const noexcept;
  /// The same as split() of record `first` + k.
  [[nodiscard]] bool split(const RecordRun& run, std::uint32_t k, RingPlace& place,
                           VertexSplit& r) const noexcept;
  /// Which of so many records may have a star that a filter asks for, as far as box, level and
  /// heights tell: bit k for record `first` + k. Nothing is checked. REQUIRES: as read_run().
  /// @param is_within  All stars of the page lie in the filter's box.
  [[nodiscard]] std::uint64_t near_stars(std::uint32_t first, std::uint32_t count,
                                         const StarFilter& filter, bool is_within) const noexcept;
  /// Everything of a record but w, vl, vr and what follows from its ring.
  [[nodiscard]] bool head(std::size_t i, VertexSplit& r) const noexcept;
  /// A record. Coordinates are on the grid, u, w, vl and vr differ and lie in the roi.
  /// @param place  Of a record not behind this one; becomes that of this record.
  [[nodiscard]] bool split(std::size_t i, RingPlace& place, VertexSplit& r) const noexcept;
  /// Whether a triangle of the star of a record lives at a level, as level_bits(). True also for
  /// a ring that is not sound. REQUIRES: error_bits(i) is at or above the level.
  [[nodiscard]] bool may_live(std::size_t i, RingPlace& place, std::int32_t level) const noexcept;
  /// Appends the ring of a record whose head is `r`: is_star() is true of it.
  /// @param span  Becomes what the ring spans.
  [[nodiscard]] bool ring(std::size_t i, RingPlace& place, const VertexSplit& r,
                          std::vector<RingCorner>& out, RingSpan& span) const;

 private:
  using Run = std::array<std::uint64_t, kRun>;
  /// The fields of a corner.
  struct StoredCorner {
    std::int64_t x, y, height;
    std::uint32_t death;
    bool is_void, has_height;
  };
  [[nodiscard]] std::uint64_t number(PageColumn column, std::size_t i) const noexcept {
    return columns_.at(bytes_.data(), column, i);
  }
  void read_run(PageColumn column, std::uint32_t first, std::uint32_t count,
                Run& out) const noexcept {
    columns_.read_run(bytes_.data(), column, first, std::span(out).first(count));
  }
  [[nodiscard]] std::uint64_t near_box(std::uint32_t first, std::uint32_t count,
                                       const GridBox& box) const noexcept;
  [[nodiscard]] std::uint64_t with_heights(std::uint32_t first, std::uint32_t count,
                                           const StarFilter& filter) const noexcept;
  [[nodiscard]] std::uint64_t with_steps(std::uint32_t first, std::uint32_t count,
                                         std::span<const std::uint64_t> steps) const noexcept;
  template <class NumberOf>
  [[nodiscard]] bool head_of(const NumberOf& at, VertexSplit& r) const noexcept;
  template <class NumberOf>
  [[nodiscard]] RingShape shape_of(const NumberOf& at) const noexcept;
  template <class ShapeOf>
  [[nodiscard]] bool find(std::size_t i, RingPlace& place, const ShapeOf& shape) const noexcept;
  [[nodiscard]] bool find(std::size_t i, RingPlace& place) const noexcept;
  [[nodiscard]] bool ends_of(const RingPlace& place, VertexSplit& r) const noexcept;
  [[nodiscard]] GridPoint corner_position(GridPoint u, const RingShape& shape,
                                          std::size_t bit) const noexcept;
  [[nodiscard]] bool is_void(const RingShape& shape, std::size_t bit) const noexcept;
  template <class Visit>
  void for_each_corner(const RingPlace& place, const Visit& visit) const;

  std::span<const std::byte> bytes_;
  HeightEncoding heights_;
  PageColumns columns_;
  bool is_sound_ = false;
};

}  // namespace ptin
