// SPDX-License-Identifier: GPL-3.0-or-later
//
// The total order of records: error falling, rank falling, key rising; and its first t (the paper's
// pruned search, M_t).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

/// What places a record in the total order. What a record needs has no smaller error and a larger
/// rank (saturation), so it comes before the record: any prefix of the order, within any closed
/// set, is closed.
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
[[nodiscard]] inline RecordPlace place_of(const VertexSplit& r) noexcept {
  return {r.error, r.rank, key_of(r.u)};
}
/// True when `a` comes before `b`.
[[nodiscard]] constexpr bool is_before(const PendingSplit& a, const PendingSplit& b) noexcept {
  return place_of(a) < place_of(b);
}

/// How much the first records may add to a mesh: so many vertices, one a record, or so many
/// triangles, one a record at the border and two elsewhere (those that are void too).
struct Growth {
  enum class Of : std::uint8_t { kVertices, kTriangles };
  std::uint64_t most = 0;
  Of of = Of::kVertices;

  [[nodiscard]] constexpr std::uint64_t by(const PendingSplit& s) const noexcept {
    return of == Of::kVertices ? 1 : triangles_of(s.flags);
  }
  /// What a record adds at most.
  [[nodiscard]] constexpr std::uint64_t by_one() const noexcept {
    return of == Of::kVertices ? 1 : 2;
  }
};

/// A bound that the errors of at least `count` records of the whole file exceed, by the table of
/// errors; -1 when all are needed.
[[nodiscard]] double bound_exceeded_by(std::span<const ErrorBin> bins, std::uint64_t count);

/// The first records of the total order among those for which a predicate is true.
struct FirstRecords {
  std::vector<PendingSplit> splits;
  /// No record that was left out, of those for which the predicate is true, has an error above
  /// this. -1: none was left out.
  double largest_error_left = -1.0;
};

/// Records that are as if they were not in the file, and how many there are at most.
struct LeftOut {
  std::function<bool(VertexKey)> is;  ///< Null: none is.
  std::uint64_t count = 0;
};

/// Finds the longest prefix of the total order of the records for which `predicate` is true that
/// adds no more than `growth` says: of vertices exactly as many, unless there are fewer; of
/// triangles as many or one less. Pages are read in the order of falling largest error. A page whose largest error is below the smallest error
/// taken is not read, but for an eighth more pages (16 at least) that are read ahead, as far as the memory
/// allows. The file's
/// table of errors says where to begin; it only saves work, and may be wrong.
/// @param fixed_bytes  What the query holds besides its records (T0).
/// @throws Error resource_exhausted (before the pages concerned are read), corruption, io_error,
///               cancelled
/// Cost: O(t) records read and compared, t those that are found, times the logarithm of 1 / (the share of the
/// terrain that the predicate leaves).
[[nodiscard]] FirstRecords first_records(const RecordSource& source,
                                         const AttributePredicate& predicate, Growth growth,
                                         std::uint64_t fixed_bytes, QueryContext& context,
                                         const LeftOut& left_out = {});

}  // namespace ptin
