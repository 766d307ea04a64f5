// SPDX-License-Identifier: GPL-3.0-or-later
//
// A segment as finished pages: the part of writing a store that needs nothing of the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/layout.h"
#include "storage/page_columns.h"
#include "storage/star.h"
#include "storage/store_file.h"

namespace ptin {

/// The pages of one segment, one behind the other, and what a store says of them: whoever packs them
/// counts, and not the one who writes all.
struct PackedSegment {
  std::vector<std::byte> pages;
  std::vector<layout::NodeEntry> descriptors;  ///< One for each page.
  std::vector<ErrorBin> errors;  ///< The errors of the records, as ErrorTable::bins().
  std::uint16_t max_rank = 0;
};

/// Orders the records of a segment (storage/record_order.h) and packs them. The bytes depend on the
/// set of records, their stars and the size of a page alone. Threads: any number at once.
/// @param records  As PagePacker::add asks.
/// @throws Error internal  a record is not so
/// Memory: the pages, and 32 bytes a record while they are ordered. Cost: O(n log n).
[[nodiscard]] PackedSegment pack_segment(const StarredRecords& records,
                                         const HeightEncoding& heights, const PageForm& form,
                                         std::uint32_t page_bytes);

}  // namespace ptin
