// SPDX-License-Identifier: GPL-3.0-or-later
//
// One line of sight: which records to ask for next, until the answer is there.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/sight/sight.h"
#include "engine/query/sight/sight_predicate.h"
#include "engine/query/sight/sight_view.h"

namespace ptin {

/// Refines a mesh along one line, and only as far as the questions asked of it need. Threads: one
/// owner.
class SightSearch {
 public:
  /// All borrowed for the life of the search.
  /// @param step  Deviations below this are not worth a search of their own, height's unit.
  SightSearch(const SightFacts& facts, const SightRequest& request, BoundedMesh& mesh,
              QueryContext& context, double step);

  /// Sets the line and looks at it over the mesh as it is. REQUIRES: p != q.
  /// @param bend   Curvature::drop_at() of the line's length.
  /// @param start  Any triangle; one near p is fast.
  void begin(Spot p, Spot q, const SightPair& pair, double bend, TriangleId start);

  /// finish_ends() makes the ground below the ends exact; finish_line() makes the whole line as
  /// fine as the level of detail. Both stop when the budget is spent.
  void finish_ends();
  void finish_line();

  /// Refines until the line is known to be hidden or visible, or nothing more can be known.
  [[nodiscard]] SightVerdict decide();
  /// Refines until the first piece that is not visible is final. Returns the first hidden piece, or
  /// null. REQUIRES: decide() said hidden.
  [[nodiscard]] const SightPiece* find_first_hidden();
  /// Refines until no piece can have a smaller clearance than the least one known.
  void find_least_clearance();

  [[nodiscard]] const SightView& view() const noexcept { return view_; }
  /// The first piece that is hidden for certain, or null; valid until the mesh is refined.
  [[nodiscard]] const SightPiece* hidden_piece() const noexcept;
  [[nodiscard]] bool out_of_budget() const noexcept;
  /// True when all that is asked of the ends is known.
  [[nodiscard]] bool ends_known() const noexcept;

 private:
  using Stretch = SightPredicate::Stretch;

  void look();
  [[nodiscard]] double target(double margin, double deviation) const noexcept;
  [[nodiscard]] double quarter_of(double deviation) const noexcept;
  void settle_touch();
  [[nodiscard]] std::vector<Stretch> unfinished_stretches() const;
  [[nodiscard]] std::vector<Stretch> undecided_stretches() const;
  [[nodiscard]] std::vector<Stretch> unsettled_stretch() const;
  [[nodiscard]] std::vector<Stretch> stretch_to_first_hidden() const;
  [[nodiscard]] std::vector<Stretch> stretches_of_least(double most) const;
  void add(std::vector<Stretch>& stretches, double from, double to, double deviation) const;
  void cut_below_line(std::vector<Stretch>& stretches, double margin) const;
  void refine(std::vector<Stretch> stretches, double end_deviation, double margin);

  const SightFacts& facts_;
  const SightRequest& request_;
  BoundedMesh& mesh_;
  QueryContext& context_;
  double step_;  ///< Deviations below this are not worth a search of their own.
  Spot p_, q_;
  SightView view_;
  TriangleId start_ = 0;
};

}  // namespace ptin
