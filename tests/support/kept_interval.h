// SPDX-License-Identifier: GPL-3.0-or-later
//
// The part of a record's interval of heights that pages keep.
#pragma once

#include <cstdint>

#include "storage/page_columns.h"
#include "storage/record.h"

namespace ptin::test {

/// Rounds a record's interval outward as a page does (FORMAT.md, "Intervals"). The packer's own rule is
/// asked, which record_page_test.cc holds against what the document promises.
inline void keep_interval(VertexSplit& r, HeightType type) {
  const std::uint64_t low = ordered_height(r.height_lo, type);
  const std::uint64_t high = ordered_height(r.height_hi, type);
  if (low > high) return;  // no heights
  const std::uint64_t own = r.has_height() ? ordered_height(r.height, type) : low;
  const KeptInterval kept = kept_interval({own, low, high});
  const OrderedInterval h = interval_of(own, kept.shift, kept.below, kept.above, type);
  r.height_lo = height_of_ordered(static_cast<std::uint32_t>(h.low), type);
  r.height_hi = height_of_ordered(static_cast<std::uint32_t>(h.high), type);
}

}  // namespace ptin::test
