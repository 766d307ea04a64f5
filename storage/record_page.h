// SPDX-License-Identifier: GPL-3.0-or-later
//
// A page of records and stars as its descriptor describes it: its numbers, taken out of its bytes
// and checked (storage/FORMAT.md, "Pages").
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/attributes.h"
#include "storage/box_lanes.h"
#include "storage/descriptor.h"
#include "storage/page_columns.h"
#include "storage/page_store.h"
#include "storage/pending_split.h"
#include "storage/sample_heights.h"
#include "storage/short_float.h"
#include "storage/star.h"

namespace ptin {

class PageRun;

/// Most records of a run. Runs begin where runs of rings begin.
inline constexpr std::uint32_t kRecordRun = 64;
static_assert(kRecordRun % layout::kRingRun == 0);

/// How the corners of a ring are laid out.
struct RingShape {
  unsigned degree = 0, offset_bits = 0, height_bits = 0, death_bits = 0, corner_bits = 0;
};

/// Where the rings of a run's records lie in the page, and bits a corner.
struct RunRings {
  std::array<std::int64_t, kRecordRun> bit, corner_bits;  // NOLINT: written before read
  std::array<std::int64_t, kRecordRun> beyond;            ///< Negative: there is no ring.
  /// False when the ring cannot be one, or would not lie where rings lie.
  [[nodiscard]] bool is_sound(std::uint32_t k) const noexcept { return beyond[k] >= 0; }
};

/// What the corners of a ring, and its triangles, span.
struct RingSpan {
  std::int64_t min_x = INT64_MAX, min_y = INT64_MAX;  ///< Box of the corners, grid units.
  std::int64_t max_x = INT64_MIN, max_y = INT64_MIN;
  std::uint32_t low = UINT32_MAX, high = 0;  ///< Ordered heights; low > high: no corner has one.
  std::uint32_t least_death = UINT32_MAX;    ///< As death_bits().
};

/// What a page's descriptor admits of its records, as their columns have it.
struct HeadBounds {
  /// REQUIRES: is_sound(d, heights).
  HeadBounds(const layout::NodeEntry& d, HeightType type) noexcept;

  lanes::Int4 sides;                                 ///< Of the rois, maxima as ~max.
  std::int64_t low, high;                            ///< Ordered heights.
  std::int64_t error_min, error_max, deviation_max;  ///< Bits of short numbers.
};

/// A page. Any bytes are safe to ask: an answer of false means that a field cannot be what was
/// written, and then what was asked for is unspecified.
class RecordPage {
 public:
  /// @param path    Borrowed, as the bytes; for messages.
  /// @param bytes   Bytes of a whole page.
  /// @param floor   The heights that a local page leaves to the raster's samples; borrowed. Null where
  ///                the form says that there are none.
  /// @throws Error corruption  the descriptor or the page's header cannot be what was written, or
  ///                           they disagree on the number of records
  RecordPage(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
             const HeightEncoding& heights, const PageForm& form, std::span<const std::byte> bytes,
             SampleHeights* floor);

  [[nodiscard]] std::uint32_t records() const noexcept { return columns_.records(); }
  [[nodiscard]] const layout::NodeEntry& descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] const HeightEncoding& heights() const noexcept { return heights_; }
  [[nodiscard]] const PageColumns& columns() const noexcept { return columns_; }
  [[nodiscard]] const std::byte* bytes() const noexcept { return bytes_.data(); }
  /// The ordered height of a vertex of a local page; below least_height() where the raster has none.
  /// @throws Error corruption, io_error  the tile of heights cannot be read
  [[nodiscard]] OrderedHeight sample(std::int64_t x, std::int64_t y) const {
    return floor_->at(x, y);
  }
  [[nodiscard]] std::int64_t least_height() const noexcept { return columns_.is_local() ? 1 : 0; }

  /// Appends all records to `out`. On an error `out` is as before.
  /// @throws Error corruption  a field cannot be what was written, or lies outside of what the
  ///                           descriptor says
  void decode(std::vector<VertexSplit>& out) const;
  /// The same, with the stars.
  void decode(StarredRecords& out) const;
  /// Appends the records for which the predicate is true. They are checked as by decode(); of the
  /// other records nothing but the attributes is looked at.
  /// @throws Error as decode()
  void decode_matching(const AttributePredicate& predicate, std::vector<VertexSplit>& out) const;
  void decode_matching(const AttributePredicate& predicate, std::vector<PendingSplit>& out) const;

  /// Everything of a record but w, vl, vr and what follows from its ring. The descriptor admits it,
  /// and the roi holds u. REQUIRES: all columns of the run are taken, as for what follows.
  [[nodiscard]] bool head(const PageRun& run, std::uint32_t k, VertexSplit& r) const noexcept;
  /// Finds the rings of a run's records.
  void find_rings(const PageRun& run, RunRings& out) const noexcept;
  /// A record. u, w, vl and vr differ and lie in the roi.
  /// @param rings  Those of the run.
  [[nodiscard]] bool split(const PageRun& run, std::uint32_t k, const RunRings& rings,
                           VertexSplit& r) const noexcept;
  /// Appends the ring of a record whose head is `r`: is_star() is true of it.
  /// @param span  Becomes what the ring spans.
  [[nodiscard]] bool ring(const PageRun& run, std::uint32_t k, const RunRings& rings,
                          const VertexSplit& r, std::vector<RingCorner>& out, RingSpan& span) const;

  /// @throws Error corruption  always: `record` is not sound
  [[noreturn]] void report(std::size_t record) const;

 private:
  /// Whether the descriptor admits a star.
  [[nodiscard]] bool admits(const VertexSplit& r, const RingSpan& span) const noexcept;
  /// Where a record lies, in registers: u's key, its position twice and its roi.
  struct OwnPlace {
    VertexKey key;
    lanes::Int4 u_twice, roi;
    lanes::Int4 outside;  ///< Bits are set where the roi is none, or not one of the page.
  };
  template <class Record>
  void decode_wanted(const AttributePredicate* predicate, std::vector<Record>& out) const;
  [[nodiscard]] OwnPlace own_place(const PageRun& run, std::uint32_t k) const noexcept;
  template <class Record>
  [[nodiscard]] bool head_of(const PageRun& run, std::uint32_t k, Record& r) const noexcept;
  template <class Record>
  [[nodiscard]] static bool take_flags(std::uint64_t flags, Record& r) noexcept;
  template <class Record>
  [[nodiscard]] bool ends_of(const PageRun& run, std::uint32_t k, const RunRings& rings,
                             const OwnPlace& own, Record& r) const noexcept;
  template <class Record>
  [[nodiscard]] bool split_of(const PageRun& run, std::uint32_t k, const RunRings& rings,
                              Record& r) const noexcept;
  [[nodiscard]] RingShape shape_of(const PageRun& run, std::uint32_t k) const noexcept;
  [[nodiscard]] std::uint64_t bits_from(std::size_t bit) const noexcept;
  [[nodiscard]] lanes::Int4 corner_offsets(unsigned width, std::size_t bit,
                                           std::size_t other_bit) const noexcept;
  [[nodiscard]] bool is_void(std::int64_t corner_bits, std::size_t bit) const noexcept;
  template <class Visit>
  void for_each_corner(const RingShape& shape, std::size_t bit, const Visit& visit) const;

  const std::string& path_;
  PageId id_;
  layout::NodeEntry descriptor_;
  HeightEncoding heights_;
  std::span<const std::byte> bytes_;
  SampleHeights* floor_;
  HeadBounds bounds_;
  PageColumns columns_;
};

/// The numbers of some consecutive records of a page, taken out column by column: a number takes a
/// load and a shift for some of them then, and nothing is looked up between. A column is taken once.
class PageRun {
 public:
  static constexpr std::uint32_t kMost = kRecordRun;

  /// @param page  Borrowed.
  explicit PageRun(const RecordPage& page) noexcept : page_(page) {}

  /// Goes to the next kMost records, or those that are left; false when there are none.
  [[nodiscard]] bool next() noexcept {
    first_ += count_;
    count_ = std::min(kMost, page_.records() - first_);
    taken_.fill(0);
    return count_ > 0;
  }
  [[nodiscard]] std::uint32_t first() const noexcept { return first_; }
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }

  /// Takes a column out, and returns it.
  /// @throws Error corruption, io_error  heights of a local page, as RecordPage::sample()
  const std::uint64_t* take(PageColumn column) {
    take_some(column, all());
    return numbers_[static_cast<std::size_t>(column)].data();
  }
  void take_all();
  /// Takes the numbers of some records out: of record k where bit k is set.
  void take_some(PageColumn column, std::uint64_t records) {
    const std::uint64_t missing = records & ~taken_[static_cast<std::size_t>(column)];
    if (missing != 0) {
      read(column, missing);
    }
  }

  /// Takes what heights() wants of some records.
  void take_heights(std::uint64_t records) {
    for (const PageColumn c :
         {PageColumn::kHeight, PageColumn::kShift, PageColumn::kBelow, PageColumn::kAbove}) {
      take_some(c, records);
    }
  }

  /// A number that was taken. REQUIRES, as below: k < count().
  [[nodiscard]] std::uint64_t at(PageColumn column, std::uint32_t k) const noexcept {
    return numbers_[static_cast<std::size_t>(column)][k];
  }
  /// The roi; anything for a record that is not sound.
  /// REQUIRES: kX, kY and the four columns of its sides are taken.
  [[nodiscard]] GridBox roi(std::uint32_t k) const noexcept {
    const auto whole = [](std::uint64_t v) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(v));
    };
    const std::uint64_t x = at(PageColumn::kX, k);
    const std::uint64_t y = at(PageColumn::kY, k);
    return {whole(x - at(PageColumn::kWest, k)), whole(y - at(PageColumn::kSouth, k)),
            whole(x + at(PageColumn::kEast, k)), whole(y + at(PageColumn::kNorth, k))};
  }
  /// REQUIRES: kHeight, kShift, kBelow and kAbove are taken.
  [[nodiscard]] OrderedInterval heights(std::uint32_t k) const noexcept {
    return interval_of(at(PageColumn::kHeight, k), at(PageColumn::kShift, k),
                       at(PageColumn::kBelow, k), at(PageColumn::kAbove, k), page_.heights().type);
  }
  /// Height codes; empty for a record that has none. REQUIRES: as heights(), and kFlags.
  [[nodiscard]] Interval codes(std::uint32_t k) const noexcept {
    if ((at(PageColumn::kFlags, k) & kPageNoHeights) != 0) {
      return {};
    }
    const HeightEncoding& e = page_.heights();
    const auto code = [&](std::uint64_t ordered) {
      return e.code(height_of_ordered(static_cast<std::uint32_t>(ordered), e.type));
    };
    const OrderedInterval h = heights(k);
    return {code(h.low), code(h.high)};
  }
  /// The bits of a short number (storage/short_float.h), or more than those of infinity.
  [[nodiscard]] std::uint32_t error_bits(std::uint32_t k) const noexcept {
    return page_.columns().has_descending_errors()
               ? static_cast<std::uint32_t>(at(PageColumn::kError, k))
               : short_of_stored(at(PageColumn::kError, k), page_.columns().header().error);
  }
  [[nodiscard]] std::uint32_t deviation_bits(std::uint32_t k) const noexcept {
    return short_of_stored(at(PageColumn::kDeviation, k), page_.columns().header().deviation);
  }
  /// Nothing is checked: of a record that is not sound they may be anything.
  /// REQUIRES: all columns are taken.
  [[nodiscard]] Attributes attributes(std::uint32_t k) const noexcept {
    const auto bound = [](std::uint32_t bits) {
      return static_cast<double>(short_value(static_cast<ShortBits>(bits)));
    };
    return {roi(k), codes(k), bound(error_bits(k)), bound(deviation_bits(k))};
  }

 private:
  [[nodiscard]] std::uint64_t all() const noexcept { return ~std::uint64_t{0} >> (kMost - count_); }
  void read(PageColumn column, std::uint64_t records);
  void read_column(PageColumn column);
  void read_samples(std::uint64_t records);

  const RecordPage& page_;
  std::uint32_t first_ = 0, count_ = 0;
  std::array<std::uint64_t, kPageColumns> taken_;  // NOLINT: set by next(); bit k: of record k
  std::array<std::array<std::uint64_t, kMost>, kPageColumns>
      numbers_;  // NOLINT: written before read
};

/// @throws Error corruption  the descriptor of a page holds values that no program wrote
void check_descriptor(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                      const HeightEncoding& heights, std::size_t page_bytes);

}  // namespace ptin
