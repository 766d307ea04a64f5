// SPDX-License-Identifier: GPL-3.0-or-later
//
// One line of sight by splits: which records to ask for next, until the answer is there.
#pragma once

#include <vector>

#include "engine/query/paper/selective_refinement.h"
#include "engine/query/sight/sight_predicate.h"
#include "engine/query/sight/sight_view.h"

namespace ptin {

/// Refines T0 along one line: coarse first, and only as far as the questions asked of it need
/// (paper, section 5.3). Threads: one owner.
class SightSearch {
 public:
  /// All borrowed for the life of the search.
  /// @param line  Where to begin: before anything is known.
  SightSearch(const OpenedTerrain& terrain, const SightFacts& facts, const SightRequest& request,
              const SightView& line, QueryContext& context);

  /// finish_ends() makes the ground below the ends exact; finish_line() makes the whole line as
  /// fine as the level of detail. Both stop when the budget is spent.
  void finish_ends();
  void finish_line();
  /// Refines until the line is known to be hidden or visible, or nothing more can be known.
  [[nodiscard]] SightVerdict decide();

  [[nodiscard]] const SightLine& line() const noexcept { return view_; }
  /// True when all that is asked of the ends is known.
  [[nodiscard]] bool ends_known() const noexcept;

 private:
  using Stretch = SightPredicate::Stretch;

  [[nodiscard]] bool out_of_budget() const noexcept;
  [[nodiscard]] double target(double margin, double deviation) const noexcept;
  [[nodiscard]] std::vector<Stretch> undecided_stretches() const;
  [[nodiscard]] std::vector<Stretch> unsettled_stretch() const;
  [[nodiscard]] std::vector<Stretch> open_touch() const;
  void add(std::vector<Stretch>& stretches, double from, double to, double deviation) const;
  void refine(std::vector<Stretch> stretches, double end_deviation);

  const SightFacts& facts_;
  const SightRequest& request_;
  QueryContext& context_;
  double step_;  ///< Deviations below this are not worth a search of their own.
  BoundedMesh mesh_;
  SightView view_;
};

}  // namespace ptin
