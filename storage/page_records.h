// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records of one page: from its bytes and its descriptor, each checked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/descriptor.h"
#include "storage/page_store.h"
#include "storage/record.h"

namespace ptin {

/// A page as its descriptor describes it. The constructor checks the descriptor: kind and number of
/// records fit the page, and box, heights and errors are possible.
class DescribedPage {
 public:
  /// @param path  Borrowed; for messages.
  /// @throws Error corruption
  DescribedPage(const std::string& path, PageId id, const layout::NodeEntry& descriptor,
                const HeightEncoding& heights, std::uint32_t page_bytes);

  [[nodiscard]] const layout::NodeEntry& descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] std::uint32_t page_bytes() const noexcept { return page_bytes_; }
  [[nodiscard]] RecordKind kind() const noexcept {
    return (descriptor_.kind_and_count & layout::kWidePage) != 0 ? RecordKind::kWide
                                                                 : RecordKind::kNarrow;
  }
  [[nodiscard]] std::uint32_t records() const noexcept {
    return descriptor_.kind_and_count & (layout::kWidePage - 1);
  }

  /// Appends all records of the page to `out`. On an error `out` is as before.
  /// @throws Error corruption  a field cannot be what was written, or lies outside of what the
  ///                           descriptor says
  void decode(std::span<const std::byte> bytes, std::vector<VertexSplit>& out) const;

  /// Appends the records for which the predicate is true. They are checked as by decode(); of the
  /// other records nothing but the attributes is looked at.
  /// @throws Error as decode()
  void decode_matching(std::span<const std::byte> bytes, const AttributePredicate& predicate,
                       std::vector<VertexSplit>& out) const;

 private:
  /// The number of records before the first one that the descriptor excludes.
  [[nodiscard]] std::size_t admitted(std::span<const VertexSplit> records) const noexcept;
  [[nodiscard]] std::size_t find_near(std::span<const std::byte> bytes, const GridBox& box,
                                      std::span<std::uint16_t> near) const noexcept;
  [[noreturn]] void report(std::size_t record) const;

  static constexpr std::size_t kMostRecords = layout::kMaxPageBytes / sizeof(layout::NarrowRecord);

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
