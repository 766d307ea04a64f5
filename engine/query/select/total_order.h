// SPDX-License-Identifier: GPL-3.0-or-later
//
// The total order of records: error falling, rank falling, key rising; and its first t (the paper's
// pruned search, M_t).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

/// What places a record in the total order. Every record comes after what it needs, whose error is
/// not smaller and whose rank is larger (saturation): so any prefix, within any closed set, is
/// closed.
struct RecordPlace {
  float error;
  std::uint16_t rank;
  VertexKey u;
  friend constexpr bool operator<(const RecordPlace& a, const RecordPlace& b) noexcept {
    if (a.error != b.error) {
      return a.error > b.error;
    }
    return a.rank != b.rank ? a.rank > b.rank : a.u < b.u;
  }
};
[[nodiscard]] constexpr RecordPlace place_of(const PendingSplit& s) noexcept {
  return {s.error, s.rank, s.u};
}
/// True when `a` comes before `b`.
[[nodiscard]] constexpr bool is_before(const PendingSplit& a, const PendingSplit& b) noexcept {
  return place_of(a) < place_of(b);
}

/// The first records of the total order among those for which a predicate is true.
struct FirstRecords {
  std::vector<PendingSplit> splits;
  /// No record left out (for which the predicate is true) is above; -1: none is left out.
  double largest_error_left = -1.0;
};

/// Finds the first `count` records, or all there are. Reads pages in order of falling largest
/// error, and no page whose largest error is below the smallest one taken, but for an eighth more
/// read ahead. The file's table of errors says where to begin; it only saves work, and may be
/// wrong.
/// @throws Error resource_exhausted (before the pages concerned are read), corruption, io_error,
///               cancelled
/// Cost: O(t) records read and compared, times the logarithm of what share of the terrain the
/// predicate leaves.
[[nodiscard]] FirstRecords first_records(const RecordSource& source,
                                         const AttributePredicate& predicate, std::uint64_t count,
                                         std::uint64_t fixed_bytes, QueryContext& context);

}  // namespace ptin
