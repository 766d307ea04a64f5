// SPDX-License-Identifier: GPL-3.0-or-later
//
// What applying and undoing splits have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh/split.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

/// The counting sort of records by falling rank (paper, section 4): hands out places in the sorted
/// order.
class RankOrder {
 public:
  RankOrder() = default;
  explicit RankOrder(std::span<const PendingSplit> splits) {
    for (const PendingSplit& s : splits) {
      count(s.rank);
    }
    begin();
  }
  /// Counts a record. Each comes before begin().
  void count(std::uint16_t rank) {
    if (rank >= next_.size()) [[unlikely]] {
      next_.resize(std::size_t{rank} + 1);
    }
    ++next_[rank];
  }
  /// Turns the counts into places.
  void begin() noexcept {
    std::uint32_t before = 0;
    for (std::size_t rank = next_.size(); rank-- > 0;) {
      before += std::exchange(next_[rank], before);
    }
  }
  /// The place of the next record of this rank.
  std::uint32_t take(std::uint16_t rank) noexcept { return next_[rank]++; }

 private:
  std::vector<std::uint32_t> next_;  ///< For each rank the next place.
};

/// A record's split in local indices.
[[nodiscard]] inline SplitSite site_of(VertexId u, VertexId w, VertexId vl, VertexId vr,
                                       std::uint32_t flags) noexcept {
  static_assert(static_cast<int>(TriangleClass::kVoid) == 1);
  const auto has = [flags](std::uint32_t bit) { return flags / bit % 2; };  // without branches
  return {u,
          w,
          vl,
          vr,
          has(VertexSplit::kNoLeft) == 0,
          has(VertexSplit::kNoRight) == 0,
          static_cast<TriangleClass>(has(VertexSplit::kLeftVoid)),
          static_cast<TriangleClass>(has(VertexSplit::kRightVoid))};
}

/// Refuses a record that does not fit the mesh.
/// @param why  A clause: "it does not fit the mesh".
/// @throws Error corruption  always; names page and vertex
[[noreturn]] void throw_refused(const PendingSplit& s, const std::string& why,
                                const QueryContext& context);

}  // namespace ptin
