// SPDX-License-Identifier: GPL-3.0-or-later
//
// The best-first search of highest(): gathers the highest vertices, and the records that reach
// above them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/infinity.h"
#include "engine/geometry/key_table.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/region.h"
#include "engine/query/select/retrieval.h"
#include "storage/packed_rtree.h"

namespace ptin {

/// A vertex that may be among the highest.
struct HighCandidate {
  double value;  ///< Its height's code, negated when the lowest are wanted.
  VertexKey key;
};

/// Gathers, in one search, the best vertices, and the records that reach above the very best one.
/// "Above" means below when the lowest are wanted. Threads: one owner.
class HighGatherer final : public BestFirstVisitor {
 public:
  /// All borrowed for the life of the gatherer.
  /// @param predicate  Region of the request and tolerance of `detail`.
  /// @param window     Vertices outside of it do not count; null: everywhere.
  HighGatherer(const StoreFile& store, const AttributePredicate& predicate, const Detail& detail,
               const GridRegion* window, bool lowest, QueryContext& context)
      : store_(store),
        predicate_(predicate),
        detail_(detail),
        window_(window),
        lowest_(lowest),
        context_(context) {}

  /// Begins a search for `wanted` vertices. Vertices that tell() said to be off the surface do not
  /// count. REQUIRES: wanted > 0.
  void start(std::size_t wanted);

  /// Makes room for `more` calls of tell(). Cost: linear in all vertices told of when the room
  /// grows.
  void reserve_told(std::size_t more);
  /// Tells whether a vertex is of the surface. REQUIRES: not told before; reserve_told() made room.
  void tell(VertexKey key, bool on_surface) noexcept { told_.insert(key, on_surface ? 1 : 0); }
  [[nodiscard]] bool is_told(VertexKey key) const noexcept {
    return told_.find(key) != KeyTable::kAbsent;
  }
  [[nodiscard]] bool is_rejected(VertexKey key) const noexcept { return told_.find(key) == 0; }

  /// The best value below these attributes, at the least key in their box; a value of -infinity
  /// where the predicate is false or all is void.
  [[nodiscard]] Merit bound(const Attributes& a) const override;
  /// Takes a page's vertices and records; returns the smallest bound that is still worth a visit.
  Merit visit(PageId page) override;

  /// The best vertices, by falling value, of equal ones by key; fewer than wanted when there are fewer. Ends the search.
  /// Cost: n log n.
  [[nodiscard]] std::vector<HighCandidate> take_best();

  [[nodiscard]] const Detail& detail() const noexcept { return detail_; }
  /// Bytes kept between searches: the records gathered, and what was told.
  [[nodiscard]] std::uint64_t held_bytes() const noexcept;

  /// The records that reach above the best vertex, a set closed under dependency.
  [[nodiscard]] std::vector<PendingSplit> take_splits();

 private:
  struct Reaching {
    PendingSplit split;
    double bound;
  };
  static Merit merit_of(const HighCandidate& c) noexcept { return {c.value, c.key}; }
  /// The order of the best vertices, which no file's layout changes. In the heap the last of them
  /// is on top.
  static bool is_better(const HighCandidate& a, const HighCandidate& b) noexcept {
    return merit_of(b).is_below(merit_of(a));
  }
  void offer(GridPoint p, HeightBits height);
  void drop_what_ends_below();
  /// No vertex at or below this is wanted: it is the last of the best ones.
  [[nodiscard]] Merit cut_off() const noexcept {
    return heap_.size() == wanted_ ? merit_of(heap_.front()) : kNoMerit;
  }

  const StoreFile& store_;
  const AttributePredicate& predicate_;
  const Detail& detail_;
  const GridRegion* window_;
  bool lowest_;
  QueryContext& context_;
  std::size_t wanted_ = 1;
  double most_ = -kInfinity;  ///< The best value found.
  std::vector<HighCandidate> heap_;
  std::vector<Reaching> splits_;
  std::size_t looked_through_ = 0;  ///< Splits left by the last drop_what_ends_below().
  std::vector<VertexSplit> records_;
  KeyTable told_;  ///< 1: on the surface, 0: rejected.
  std::size_t told_capacity_ = 0;
};

}  // namespace ptin
