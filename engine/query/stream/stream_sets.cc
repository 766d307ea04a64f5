// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/stream_sets.h"

#include <algorithm>
#include <array>
#include <utility>

namespace ptin {

namespace {

PredicatePtr within(const PredicatePtr& predicate, const GridBox* box) {
  return box == nullptr ? predicate : all_of({predicate, std::make_shared<MeetsBox>(*box)});
}

}  // namespace

std::vector<PageId> StreamSets::pages(const GridBox* box, QueryContext& context) const {
  std::vector<PredicatePtr> any{wanted_.predicate};
  for (const Set& set : held_) any.push_back(set.predicate);
  std::vector<PageId> pages;
  source_.index.search(*within(any_of(std::move(any)), box), pages, context.cost.io);
  context.check_stop();
  return pages;
}

void StreamSets::read(PageId page, const Set& set, const GridBox* box, QueryContext& context,
                      std::vector<PendingSplit>& out) const {
  const std::size_t before = out.size();
  context.cost.records_examined += source_.store.read_matching(
      page, *within(set.predicate, box), out, context.heights(), context.cost.io);
  context.cost.records_retrieved += out.size() - before;
  if (!set.end) return;
  const auto first = out.begin() + static_cast<std::ptrdiff_t>(before);
  out.erase(std::remove_if(first, out.end(),
                           [&](const PendingSplit& s) { return !(place_of(s) < *set.end); }),
            out.end());
}

void StreamSets::read(PageId page, const GridBox* box, QueryContext& context, Records& out) const {
  context.check_stop();
  const auto missing = static_cast<std::ptrdiff_t>(out.missing.size());
  read(page, wanted_, box, context, out.missing);
  if (held_.empty()) return;
  const auto by_key = [](const PendingSplit& a, const PendingSplit& b) { return a.u < b.u; };
  const auto is_same = [](const PendingSplit& a, const PendingSplit& b) { return a.u == b.u; };
  std::vector<PendingSplit> held;
  for (const Set& set : held_) read(page, set, box, context, held);
  std::sort(held.begin(), held.end(), by_key);
  held.erase(std::unique(held.begin(), held.end(), is_same), held.end());
  const auto is_held = [&](const PendingSplit& s) {
    return std::binary_search(held.begin(), held.end(), s, by_key);
  };
  out.missing.erase(std::remove_if(out.missing.begin() + missing, out.missing.end(), is_held),
                    out.missing.end());
  out.held.insert(out.held.end(), held.begin(), held.end());
}

}  // namespace ptin
