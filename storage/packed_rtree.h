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

/// What a best-first search asks, and gives.
class BestFirstVisitor {
 public:
  BestFirstVisitor() = default;
  BestFirstVisitor(const BestFirstVisitor&) = delete;
  BestFirstVisitor& operator=(const BestFirstVisitor&) = delete;
  virtual ~BestFirstVisitor() = default;
  /// The best that anything with these attributes can be; -infinity: nothing. Monotone: not smaller
  /// for larger attributes.
  [[nodiscard]] virtual double bound(const Attributes& a) const = 0;
  /// Called for pages in the order of falling bounds. Returns the cut-off: what is bounded below it
  /// is not visited any more. It never falls.
  virtual double visit(PageId page) = 0;
};

class PackedRTree final : public RecordIndex {
 public:
  /// @param nodes    Borrowed for the life of the index.
  /// @param heights  How entries hold heights.
  PackedRTree(const IndexNodes& nodes, const HeightEncoding& heights)
      : nodes_(nodes), heights_(heights) {}

  /// As RecordIndex::search. Entries are tested where they lie. Cost: one call of the predicate for
  /// each entry of each node visited; a node is visited when its own entry satisfies the predicate.
  /// The nodes of a level that were never read are announced together before they are.
  void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
              IoCounters& counters) const override;

  /// Visits pages best first, until the cut-off is above the bound of all that is left.
  /// @throws Error corruption; what the visitor throws
  /// Cost: nodes and pages whose bound is at least the final cut-off, times a logarithm.
  void search_best_first(BestFirstVisitor& visitor, IoCounters& counters) const;

 private:
  struct Place {
    std::uint32_t level;
    std::uint64_t number, checksum;
  };
  [[nodiscard]] layout::NodeEntry sound_entry(const layout::IndexNode& node, std::uint32_t level,
                                              std::uint64_t number, std::uint32_t i) const;
  template <class Take>
  void visit(const Place& at, const AttributePredicate& predicate, IoCounters& counters,
             const Take& take) const;

  const IndexNodes& nodes_;
  HeightEncoding heights_;
};

}  // namespace ptin
