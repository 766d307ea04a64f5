// SPDX-License-Identifier: GPL-3.0-or-later
//
// The packed R-tree: static, bulk-loaded once, children implicit by position, read in place
// (storage/FORMAT.md, "Index").
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/height.h"
#include "storage/index.h"
#include "storage/index_nodes.h"
#include "storage/merit.h"

namespace ptin {

class DescribedPageStore;

/// A page of stars that a search found.
struct StarPage {
  PageId id{};
  float error = 0.0F;  ///< Largest error of its records.
  std::uint32_t records = 0;
};

/// The caller's part of a best-first search: bounds, and what is done with each page.
class BestStarVisitor {
 public:
  BestStarVisitor() = default;
  BestStarVisitor(const BestStarVisitor&) = delete;
  BestStarVisitor& operator=(const BestStarVisitor&) = delete;
  virtual ~BestStarVisitor() = default;
  /// An upper bound of the merit of any star within these attributes: larger ones have no smaller
  /// bound.
  [[nodiscard]] virtual Merit bound(const StarAttributes& a) const = 0;
  /// The same for a node, whose turn among the pages this decides.
  /// @param level  Level of the node: 0 is a leaf, above pages.
  [[nodiscard]] virtual Merit bound_of_node(const StarAttributes& a, std::uint32_t level) const {
    static_cast<void>(level);
    return bound(a);
  }
  /// Whether all that passes the filter will probably be visited: of a far file it is then announced
  /// together. A hint.
  [[nodiscard]] virtual bool wants_all() const { return false; }
  /// Called when pages of a far file were announced, with the boxes of their stars.
  virtual void will_visit(std::span<const GridBox> stars) { static_cast<void>(stars); }
  /// Called for pages in the order of falling bounds. Returns the cut-off: pages and nodes whose
  /// bound is below it are not visited.
  /// @param a  What the descriptor says of the page's stars.
  virtual Merit visit(PageId page, const StarAttributes& a) = 0;
};

class PackedRTree final : public RecordIndex {
 public:
  /// @param nodes    Borrowed for the life of the index.
  /// @param heights  How entries hold heights.
  /// @param pages    The same file's, borrowed: where that is far, a best-first search announces
  ///                 pages too. Null: it does not.
  PackedRTree(const IndexNodes& nodes, const HeightEncoding& heights,
              const DescribedPageStore* pages = nullptr)
      : nodes_(nodes), heights_(heights), pages_(pages) {}

  /// As RecordIndex::search. Entries are tested where they lie. Nodes of a level that were never
  /// read are announced together before they are read. Cost: one call of the predicate for each
  /// entry of each node visited; a node is visited when its own entry satisfies the predicate.
  void search(const AttributePredicate& predicate, std::vector<PageId>& pages,
              IoCounters& counters) const override;

  /// Appends the pages with a star that may hold what the filter asks for, each once, ascending,
  /// with what their descriptors say of their stars. Cost: as search().
  /// @throws Error corruption, io_error
  void search_stars(const StarFilter& filter, std::vector<StarPage>& pages,
                    IoCounters& counters) const;

  /// Visits pages with a star that may hold what the filter asks for, best first, until the bounds
  /// of all that are left lie below the cut-off.
  /// @param cut_off  Until the first page is visited.
  /// @throws Error corruption, io_error; what the visitor throws
  /// Cost: the nodes and pages whose bound is at least the final cut-off, times a logarithm; the
  /// visitor is asked about entries that pass the filter alone.
  void search_stars_best_first(const StarFilter& filter, BestStarVisitor& visitor, Merit cut_off,
                               IoCounters& counters) const;

 private:
  struct NodePlace {
    std::uint32_t level;
    std::uint64_t number, checksum;
  };
  class Waiting;
  class BestFirst;
  [[nodiscard]] bool is_at_hand(const Waiting& w) const noexcept;
  template <class Test, class Take>
  void descend(const Test& test, IoCounters& counters, const Take& take) const;
  template <class Test, class Take>
  void visit(const NodePlace& at, const Test& test, IoCounters& counters, const Take& take) const;

  const IndexNodes& nodes_;
  HeightEncoding heights_;
  const DescribedPageStore* pages_;
};

}  // namespace ptin
