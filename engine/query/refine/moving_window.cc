// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/moving_window.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/error.h"
#include "engine/mesh/compact.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

namespace {

/// True where two predicates may differ: for every page and subtree with a record for which exactly
/// one of them is true. That one is true for the record, and so for the page that holds it; the
/// other one is false for the record, and so not true for all records of the page.
class MayDiffer final : public AttributePredicate {
 public:
  MayDiffer(const AttributePredicate& was, const AttributePredicate& now) : was_(was), now_(now) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return (now_.holds(a) && !was_.holds_for_all(a, 0.0)) ||
           (was_.holds(a) && !now_.holds_for_all(a, 0.0));
  }

 private:
  const AttributePredicate& was_;
  const AttributePredicate& now_;
};

}  // namespace

MovingWindow::MovingWindow(OpenedTerrain terrain, MovingWindowOptions options)
    : terrain_(std::move(terrain)),
      options_(options),
      refinement_(terrain_.t0()),
      errors_(terrain_.store()),
      cache_(terrain_.store(), options_.page_cache_bytes) {
  if (options_.page_cache_bytes > options_.memory_bytes) {
    refuse("the cache of pages is larger than the whole memory limit: expected at most that");
  }
}

MoveResult MovingWindow::move_to(PredicatePtr predicate, const std::stop_token& stop) {
  if (predicate == nullptr) {
    refuse("the predicate to move to is null");
  }
  const auto start = std::chrono::steady_clock::now();
  if (is_spoilt_) {
    reset();
  }
  QueryContext context({options_.memory_bytes, stop}, terrain_.store().path());
  const std::vector<Candidate> pages = candidates(*predicate, context);
  Change change = compare(pages, *predicate, context);
  terrain_.store().pages().check_unchanged();
  carry_out(change, context);
  predicate_ = std::move(predicate);

  MoveResult result;
  result.entered = change.entering.size();
  result.left = change.leaving.size();
  result.vertices = refinement_.alive_vertices();
  result.triangles = refinement_.alive_triangles();
  result.pages_examined = pages.size();
  result.certificate = errors_.certificate();
  result.cost = context.cost;
  result.cost.seconds = seconds_since(start);
  return result;
}

/// Pages that may hold a record that enters or leaves, ascending.
std::vector<PageId> MovingWindow::search(const AttributePredicate& predicate,
                                         QueryContext& context) const {
  const RecordIndex& index = terrain_.index();
  std::vector<PageId> pages;
  if (predicate_ != nullptr) {
    index.search(MayDiffer(*predicate_, predicate), pages, context.cost.io);
  } else {
    index.search(predicate, pages, context.cost.io);
  }
  context.check_stop();
  return pages;
}

/// The pages whose applied records may have to change, among those found. Asks for the memory that
/// the change may take.
std::vector<MovingWindow::Candidate> MovingWindow::candidates(const AttributePredicate& predicate,
                                                              QueryContext& context) const {
  std::vector<Candidate> result;
  std::uint64_t most = refinement_.alive_vertices();
  for (const PageId page : search(predicate, context)) {
    const StoreFile::PageInfo info = terrain_.store().page_info(page);
    const auto held = held_.find(index_of(page));
    const std::uint32_t count = held == held_.end() ? 0 : held->second.count;
    const bool any = predicate.holds(info.attributes);
    const bool all = any && predicate.holds_for_all(info.attributes, info.min_error);
    if ((!any && count == 0) || (all && count == info.records)) {
      continue;
    }
    most += any ? info.records - count : 0;
    result.push_back({page, !any, all});
  }
  const std::uint64_t places = std::max<std::uint64_t>(most, refinement_.tin().vertices.size());
  // A mesh that grows takes half more than it needs (Refinement::apply).
  context.admit(options_.page_cache_bytes + refinement_bytes(places + places / 2));
  return result;
}

MovingWindow::Change MovingWindow::compare(const std::vector<Candidate>& pages,
                                           const AttributePredicate& predicate,
                                           QueryContext& context) {
  std::vector<PageId> ids;
  ids.reserve(pages.size());
  for (const Candidate& c : pages) {
    ids.push_back(c.page);
  }
  cache_.announce(ids, context);
  Change change;
  for (const Candidate& c : pages) {
    context.check_stop();
    compare_page(c, predicate, context, change);
  }
  context.cost.records_retrieved += change.entering.size();
  return change;
}

void MovingWindow::compare_page(const Candidate& page, const AttributePredicate& predicate,
                                QueryContext& context, Change& change) {
  const std::span<const VertexSplit> records = cache_.records(page.page, context);
  const auto before = held_.find(index_of(page.page));
  Held now = before == held_.end() ? Held{} : before->second;
  now.bits.resize((records.size() + 63) / 64, 0);
  const std::size_t entered = change.entering.size();
  const std::size_t left = change.leaving.size();
  for (std::size_t i = 0; i < records.size(); ++i) {
    const bool wanted =
        page.all || (!page.none &&
                     predicate.holds(attributes_of(records[i], terrain_.store().facts().heights)));
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    if (wanted == ((now.bits[i / 64] & bit) != 0)) {
      continue;
    }
    now.bits[i / 64] ^= bit;
    (wanted ? change.entering : change.leaving).push_back(pending_of(records[i], page.page));
  }
  context.cost.records_examined += records.size();
  now.count += static_cast<std::uint32_t>(change.entering.size() - entered);
  now.count -= static_cast<std::uint32_t>(change.leaving.size() - left);
  if (change.entering.size() != entered || change.leaving.size() != left) {
    change.pages.emplace_back(page.page, std::move(now));
  }
}

/// Undoes the records that leave, then applies those that enter. In between the mesh has the
/// records for which both predicates are true, a closed set.
void MovingWindow::carry_out(Change& change, QueryContext& context) {
  is_spoilt_ = true;
  try {
    refinement_.undo(change.leaving, context);
    refinement_.apply(change.entering, context);
    note(change);
  } catch (...) {
    reset();  // or, where there is no memory for that, before the next move
    throw;
  }
  is_spoilt_ = false;
}

/// Notes which records of the pages are applied now, and their errors.
void MovingWindow::note(Change& change) {
  for (auto& [page, held] : change.pages) {
    if (held.count == 0) {
      held_.erase(index_of(page));
    } else {
      held_[index_of(page)] = std::move(held);
    }
  }
  for (const PendingSplit& s : change.leaving) {
    errors_.remove(s.error);
  }
  for (const PendingSplit& s : change.entering) {
    errors_.add(s.error);
  }
}

void MovingWindow::reset() {
  refinement_ = Refinement(terrain_.t0());
  predicate_ = nullptr;
  held_.clear();
  errors_ = AppliedErrors(terrain_.store());
  is_spoilt_ = false;
}

Tin MovingWindow::compact_tin() const {
  Tin tin = refinement_.tin();
  compact_triangles(tin);
  compact_vertices(tin);
  return tin;
}

}  // namespace ptin
