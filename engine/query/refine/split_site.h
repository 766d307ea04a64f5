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
  explicit RankOrder(std::span<const PendingSplit> splits) {
    for (const PendingSplit& s : splits) {
      if (s.rank >= next_.size()) [[unlikely]] {
        next_.resize(std::size_t{s.rank} + 1);
      }
      ++next_[s.rank];
    }
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
  const auto class_of = [flags](std::uint32_t bit) {
    return (flags & bit) != 0 ? TriangleClass::kVoid : TriangleClass::kSurface;
  };
  return {u,
          w,
          vl,
          vr,
          (flags & VertexSplit::kNoLeft) == 0,
          (flags & VertexSplit::kNoRight) == 0,
          class_of(VertexSplit::kLeftVoid),
          class_of(VertexSplit::kRightVoid)};
}

/// Refuses a record that does not fit the mesh.
/// @param why  A clause: "it does not fit the mesh".
/// @throws Error corruption  always; names page and vertex
[[noreturn]] void throw_refused(const PendingSplit& s, const std::string& why,
                                const QueryContext& context);

}  // namespace ptin
