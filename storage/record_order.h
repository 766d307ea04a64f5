// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of records inside a segment of the file (engine/DECISIONS.md, section 6.1).
#pragma once

#include <cstdint>
#include <vector>

#include "storage/star.h"

namespace ptin {

/// Orders the records of a segment for pages that are filled one after the other, so that pages
/// have small boxes of stars and records of like error. The segment is cut in two, and the parts
/// again and again, down to a few records. Each cut is the one after which the parts cover the
/// least area and reach up to the least errors. The last parts come by falling error (in steps of
/// 1/64 octave), then by the key of u.
///
/// Returns the indices of the records in that order, which depends on the set of records alone.
/// REQUIRES: no u comes twice. Memory: 32 bytes a record. Cost: O(n log n), about 0.2 microseconds
/// a record in a segment of 50 000.
[[nodiscard]] std::vector<std::uint32_t> order_of_segment(const StarredRecords& records);

}  // namespace ptin
