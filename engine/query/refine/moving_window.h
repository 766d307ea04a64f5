// SPDX-License-Identifier: GPL-3.0-or-later
//
// The moving window (paper, section 7): a refined mesh that follows a predicate, splitting what
// enters and collapsing what leaves.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include "engine/memory_units.h"
#include "engine/mesh/tin.h"
#include "engine/query/refine/page_cache.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
#include "storage/store_file.h"

namespace ptin {

struct MovingWindowOptions {
  /// Most bytes for the mesh, the records that a move retrieves, and the page cache. The need is
  /// known before a page is read.
  std::uint64_t memory_bytes = kMemoryOfQuestion;
  /// The part of memory_bytes for pages that are kept between moves: 72 bytes a record. The pages
  /// used longest ago are dropped, and read again when a move needs them.
  std::uint64_t page_cache_bytes = std::uint64_t{256} << 20;
};

/// What a move did, and what the mesh is now.
struct MoveResult {
  std::uint64_t entered = 0;         ///< Splits made.
  std::uint64_t left = 0;            ///< Splits undone.
  std::uint64_t vertices = 0;        ///< The mesh's, T0 and those without a height included.
  std::uint64_t triangles = 0;       ///< Triangles of the mesh.
  std::uint64_t pages_examined = 0;  ///< Pages whose records were tested, read or from the cache.
  Certificate certificate;           ///< Over the whole domain.
  /// Pages from the cache do not count as read. records_retrieved counts the records that entered.
  QueryCost cost;
};

/// A mesh over the whole domain that is, after each move, equal as a set of triangles to a fresh
/// refinement by the predicate moved to: windows, polygons, views, tolerances, anything monotone.
///
/// Why it works: for monotone predicates p and q the records with p and q are closed under
/// dependency, so those with p alone can be undone in reverse order, and those with q alone applied
/// on top. Which records change is found through the index: a page is left alone when both
/// predicates are false for all of it, or true for all of it (holds_for_all()).
///
/// Threads: one owner. Several windows may move over one store at once.
class MovingWindow {
 public:
  /// The mesh is T0.
  /// @param terrain  A copy, which shares the file.
  /// @throws Error invalid_argument when the cache is larger than the whole limit
  explicit MovingWindow(OpenedTerrain terrain, MovingWindowOptions options = {});
  MovingWindow(const MovingWindow&) = delete;
  MovingWindow& operator=(const MovingWindow&) = delete;

  /// Changes the mesh into that of `predicate`.
  /// @throws Error invalid_argument (null), resource_exhausted (before a page is read), corruption,
  /// io_error, cancelled. The mesh stays as it was, unless the error came while the mesh was being
  /// changed (a damaged record, a late cancellation, no memory): then it is T0 again. Where there
  /// is no memory for T0 either, it becomes T0 when the next move begins. In each case the next
  /// move works.
  /// Cost: the index entries and pages on which the old and the new predicate may differ (a page is
  /// read once, then kept in the cache); O(1) expected for each record that enters or leaves.
  MoveResult move_to(PredicatePtr predicate, const std::stop_token& stop = {});

  /// The mesh. Removed vertices and triangles stand among the others, and later moves use their
  /// places again. A move does not change the ids of what stays.
  [[nodiscard]] const Tin& tin() const noexcept { return refinement_.tin(); }
  /// Local index of a vertex, or kNone.
  [[nodiscard]] VertexId find(VertexKey key) const noexcept { return refinement_.find(key); }
  /// A copy without removed vertices and triangles. Cost: linear.
  [[nodiscard]] Tin compact_tin() const;

  /// Bytes of the pages that are kept.
  [[nodiscard]] std::uint64_t page_cache_bytes() const noexcept { return cache_.bytes(); }

 private:
  /// Which records of a page are applied: one bit each, and how many.
  struct Held {
    std::vector<std::uint64_t> bits;
    std::uint32_t count = 0;
  };
  /// A page that may change, and what is known of it beforehand.
  struct Candidate {
    PageId page;
    bool none = false;  ///< Nothing of it is wanted.
    bool all = false;   ///< Everything of it is wanted.
  };
  struct Change {
    std::vector<PendingSplit> entering, leaving;
    std::vector<std::pair<PageId, Held>> pages;
  };
  [[nodiscard]] std::vector<PageId> search(const AttributePredicate& predicate,
                                           QueryContext& context) const;
  [[nodiscard]] std::vector<Candidate> candidates(const AttributePredicate& predicate,
                                                  QueryContext& context) const;
  [[nodiscard]] Change compare(const std::vector<Candidate>& pages,
                               const AttributePredicate& predicate, QueryContext& context);
  void compare_page(const Candidate& page, const AttributePredicate& predicate,
                    QueryContext& context, Change& change);
  void carry_out(Change& change, QueryContext& context);
  void note(Change& change);
  void reset();

  OpenedTerrain terrain_;
  MovingWindowOptions options_;
  Refinement refinement_;
  PredicatePtr predicate_;                        ///< The mesh's own; null: nothing is applied.
  std::unordered_map<std::uint64_t, Held> held_;  ///< By page; only pages with an applied record.
  AppliedErrors errors_;
  bool is_spoilt_ = false;  ///< Changed in part: to be reset before it is used again.
  PageCache cache_;
};

}  // namespace ptin
