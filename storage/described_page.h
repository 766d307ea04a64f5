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
#include "storage/living_stars.h"
#include "storage/page_store.h"
#include "storage/record_page.h"
#include "storage/star.h"

namespace ptin {

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

  /// Appends what lives at the filter's level (StoreFile::read_living).
  /// @throws Error as decode()
  void decode_living(std::span<const std::byte> bytes, const StarFilter& filter,
                     LivingStars& out) const;

  /// @throws Error corruption  always: `record` is not sound
  [[noreturn]] void report(std::size_t record) const;

 private:
  /// Whether the descriptor admits a star.
  [[nodiscard]] bool admits(const VertexSplit& r, const RingSpan& span) const noexcept;
  /// The number of records before the first one that the descriptor excludes.
  [[nodiscard]] std::size_t admitted(std::span<const VertexSplit> records) const noexcept;
  template <class Bounds>
  void decode_within(std::span<const std::byte> bytes, const Bounds& bounds,
                     const AttributePredicate& predicate, std::vector<VertexSplit>& out) const;

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
    return of(page.page_bytes());
  }
  [[nodiscard]] std::span<std::byte> of(std::uint32_t page_bytes) noexcept {
    return {bytes_.data(), page_bytes};
  }

 private:
  alignas(64) std::array<std::byte, layout::kMaxPageBytes> bytes_;
};

}  // namespace ptin
