// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records of one page and their stars: from its bytes and its descriptor, each checked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/descriptor.h"
#include "storage/page_columns.h"
#include "storage/page_store.h"
#include "storage/star.h"

namespace ptin {

/// Where a ring begins, and how to get to the next one without a look at those before it.
struct RingPlace {
  std::size_t record = SIZE_MAX;  ///< None yet.
  std::size_t bit = 0;            ///< In the page.
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

  /// The roi of a record. Nothing is checked. REQUIRES, as all that follows: i < records().
  [[nodiscard]] GridBox roi(std::size_t i) const noexcept;
  /// The first record from i on whose roi may meet a box; records() when there is none.
  [[nodiscard]] std::uint32_t next_near(std::uint32_t i, const GridBox& box) const noexcept;
  /// The bits of a short number (storage/short_float.h), or more than those of infinity.
  [[nodiscard]] std::uint32_t error_bits(std::size_t i) const noexcept {
    return short_of_stored(number(PageColumn::kError, i), columns_.header().error);
  }
  /// The attributes of so many records from `first` on. Nothing is checked: of a record that is not
  /// sound they may be anything. REQUIRES: count <= kRun, first + count <= records().
  static constexpr std::uint32_t kRun = 64;
  using AttributeRun = std::array<Attributes, kRun>;
  void attributes(std::uint32_t first, std::uint32_t count, AttributeRun& out) const noexcept;
  /// Everything of a record but w, vl, vr and what follows from its ring.
  [[nodiscard]] bool head(std::size_t i, VertexSplit& r) const noexcept;
  /// A record. Coordinates are on the grid, u, w, vl and vr differ and lie in the roi.
  /// @param place  Of a record not behind this one; becomes that of this record.
  [[nodiscard]] bool split(std::size_t i, RingPlace& place, VertexSplit& r) const noexcept;
  /// Appends the ring of a record whose head is `r`: is_star() is true of it.
  [[nodiscard]] bool ring(std::size_t i, RingPlace& place, const VertexSplit& r,
                          std::vector<RingCorner>& out) const;

 private:
  /// How the corners of a ring are laid out.
  struct RingShape {
    unsigned degree, offset_bits, height_bits, death_bits, corner_bits;
    [[nodiscard]] std::size_t bits() const noexcept { return std::size_t{degree} * corner_bits; }
  };
  /// The fields of a corner.
  struct StoredCorner {
    std::int64_t x, y, height;
    std::uint32_t death;
    bool is_void, has_height;
  };
  [[nodiscard]] std::uint64_t number(PageColumn column, std::size_t i) const noexcept {
    return columns_.at(bytes_.data(), column, i);
  }
  [[nodiscard]] RingShape shape_of(std::size_t i) const noexcept;
  [[nodiscard]] bool find(std::size_t i, const RingShape& shape, RingPlace& place) const noexcept;
  [[nodiscard]] GridPoint corner_position(GridPoint u, const RingShape& shape,
                                          std::size_t bit) const noexcept;
  [[nodiscard]] bool is_void(const RingShape& shape, std::size_t bit) const noexcept;
  [[nodiscard]] StoredCorner stored_corner(const RingShape& shape, std::size_t bit) const noexcept;
  [[nodiscard]] bool make_corner(const StoredCorner& stored, const VertexSplit& r,
                                 std::uint32_t height, ShortBits error,
                                 RingCorner& c) const noexcept;

  std::span<const std::byte> bytes_;
  HeightEncoding heights_;
  PageColumns columns_;
  bool is_sound_ = false;
};

/// A page as its descriptor describes it. The constructor checks the descriptor: the number of
/// records fits the page, and boxes, heights, errors and deaths are possible.
class DescribedPage {
 public:
  /// @param path  Borrowed; for messages.
  /// @throws Error corruption
  DescribedPage(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                const HeightEncoding& heights, std::uint32_t page_bytes);

  [[nodiscard]] const layout::NodeEntry& descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] std::uint32_t page_bytes() const noexcept { return page_bytes_; }
  [[nodiscard]] std::uint32_t records() const noexcept { return descriptor_.records; }

  /// The numbers of the page.
  /// @throws Error corruption  its header cannot be what was written, or names another number of
  ///                           records than the descriptor
  [[nodiscard]] RecordPage open(std::span<const std::byte> bytes) const;

  /// Appends all records of the page to `out`. On an error `out` is as before.
  /// @throws Error corruption  a field cannot be what was written, or lies outside of what the
  ///                           descriptor says
  void decode(std::span<const std::byte> bytes, std::vector<VertexSplit>& out) const;
  /// The same, with the stars.
  void decode(std::span<const std::byte> bytes, StarredRecords& out) const;

  /// Appends the records for which the predicate is true. They are checked as by decode(); of the
  /// other records nothing but the attributes is looked at.
  /// @throws Error as decode()
  void decode_matching(std::span<const std::byte> bytes, const AttributePredicate& predicate,
                       std::vector<VertexSplit>& out) const;

  /// Appends the stars that may hold what the filter asks for (StoreFile::read_stars).
  /// @throws Error as decode()
  void decode_stars(std::span<const std::byte> bytes, const StarFilter& filter,
                    StarredRecords& out) const;

  /// Whether the descriptor admits a star.
  [[nodiscard]] bool admits(const VertexSplit& r, std::span<const RingCorner> ring) const noexcept;
  /// @throws Error corruption  always: `record` is not sound
  [[noreturn]] void report(std::size_t record) const;

 private:
  /// The number of records before the first one that the descriptor excludes.
  [[nodiscard]] std::size_t admitted(std::span<const VertexSplit> records) const noexcept;

  const std::string& path_;
  PageId id_;
  layout::NodeEntry descriptor_;
  HeightEncoding heights_;
  std::uint32_t page_bytes_;
};

/// Room for one page of any size, on the stack, untouched until it is used.
class PageBuffer {
 public:
  PageBuffer() {}  // NOLINT: not zeroed on purpose
  [[nodiscard]] std::span<std::byte> of(const DescribedPage& page) noexcept {
    return {bytes_.data(), page.page_bytes()};
  }

 private:
  alignas(64) std::array<std::byte, layout::kMaxPageBytes> bytes_;
};

}  // namespace ptin
