// SPDX-License-Identifier: GPL-3.0-or-later
//
// The packed R-tree: static, bulk-loaded once, children implicit by position, read in place.
// FORMAT.md, "Index".
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/height.h"
#include "storage/index.h"
#include "storage/index_nodes.h"

namespace ptin {

class PackedRTree final : public RecordIndex {
 public:
  /// @param nodes    Borrowed for the life of the index.
  /// @param heights  How entries hold heights.
  PackedRTree(const IndexNodes& nodes, const HeightEncoding& heights)
      : nodes_(nodes), heights_(heights) {}

  /// As RecordIndex::search. Entries are tested where they lie; nothing is allocated but what
  /// `pages` grows by. Cost: one call of the predicate for each entry of each node visited; a node
  /// is visited when its own entry satisfies the predicate.
  void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
              IoCounters& counters) const override;

 private:
  struct Search;
  void visit(Search& search, std::uint32_t level, std::uint64_t number,
             std::uint64_t checksum) const;

  const IndexNodes& nodes_;
  HeightEncoding heights_;
};

}  // namespace ptin
