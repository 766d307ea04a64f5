// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of records inside a segment of the file (engine/DECISIONS.md, section 6.1).
#pragma once

#include <cstddef>
#include <span>

#include "storage/record.h"

namespace ptin {

/// Orders the records of a segment so that pages of `page_bytes`, filled one after the other, have
/// small boxes and records of like error: wide records first, narrow ones behind them, each cut in
/// two again and again down to single pages, where a page's share of the area and its largest error
/// grow least. The records of a page come by falling error (steps of 1/64 octave), then by the key
/// of u. The result depends on the set of records alone, as long as no u comes twice. Memory: 32
/// bytes a record, and a copy of the records. Cost: O(n log n), about 0.2 microseconds a record of
/// a segment of 50 000.
void order_segment(std::span<VertexSplit> records, std::size_t page_bytes);

}  // namespace ptin
