// SPDX-License-Identifier: GPL-3.0-or-later
//
// One line of sight by stars: which pages to read next, until the answer is there.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/living/floor_cells.h"
#include "engine/query/living/level_stars.h"
#include "engine/query/living/triangle_at.h"
#include "engine/query/living/triangle_on_line.h"
#include "engine/query/sight/coarse_ground.h"
#include "engine/query/sight/sight_search.h"
#include "storage/packed_rtree.h"

namespace ptin {

/// Looks up the triangles that live at the level and may decide the line, those that most likely do
/// so first. Pages that end below the line are never read. Those of the full TIN of a raster come from
/// its heights. Threads: one owner.
class SightStars final : public SightSearch, private BestStarVisitor, private BestCellVisitor {
 public:
  /// All borrowed for the life of the search.
  /// @param coarse  A coarse level of the terrain; null: none.
  /// @param line    Where to begin: before anything is known.
  SightStars(const OpenedTerrain& terrain, const SightFacts& facts, const SightRequest& request,
             const CoarseGround* coarse, const SightLine& line, QueryContext& context);

  [[nodiscard]] const SightLine& line() const noexcept override { return line_; }
  /// Finds the pieces that may have the smallest clearance and the first obstruction, or, for what
  /// runs along the line, all.
  void finish_line() override;
  [[nodiscard]] SightVerdict decide() override;

 private:
  /// What a search is for.
  enum class Aim : std::uint8_t {
    kVerdict,  ///< Any piece that hides the line, the highest stars first; else none is left out
               ///< that is not certainly visible.
    kLeast,    ///< The pieces that may have the smallest clearance, the highest stars first.
    kFirst,    ///< The pieces up to the first one that hides the line, in their order.
    kWhole,    ///< All pieces.
    kTouch,    ///< What meets the line in a single point.
  };
  /// A part of the way.
  struct Part {
    double from, to;
  };

  [[nodiscard]] Merit bound(const StarAttributes& a) const override;
  void will_visit(std::span<const GridBox> stars) override;
  Merit visit(PageId page, const StarAttributes& a) override;
  [[nodiscard]] Merit bound_of_cells(const GridBox& box, const Interval& codes) const override;
  [[nodiscard]] bool wants_all_cells() const override { return true; }
  bool begin_cells(const GridBox& box, Merit left) override;
  void take_cell(const LivingTriangle& t) override { take(t); }
  Merit end_cells() override { return {cut_off()}; }

  void find_ends() override;
  void state_domain(SightEnd& end, Spot spot) const;
  [[nodiscard]] std::optional<Part> part_in(const GridBox& box) const noexcept;
  [[nodiscard]] GridBox box_of(const Part& part) const noexcept;
  [[nodiscard]] double cut_off() const noexcept;
  /// True when triangles far below the line are wanted too.
  [[nodiscard]] bool wants_all() const noexcept {
    return aim_ == Aim::kWhole || aim_ == Aim::kTouch;
  }
  void look_at(const Part& part);
  void begin_search(Aim aim, Part part, LevelStars& stars);
  void search(Aim aim, Part part, LevelStars& stars);
  [[nodiscard]] bool is_cut_here(Merit bound);
  void finish_search();
  void search_whole_line(Aim aim);
  void take(const LivingTriangle& t);
  void take_abandoned(const LivingTriangle& t);
  void take_touch(const LivingTriangle& t, const LinePoint& at);
  [[nodiscard]] SightPiece piece_of(const LivingTriangle& t, const SharedStretch& on,
                                    bool is_final) const;
  [[nodiscard]] bool is_hidden_by_coarse();
  [[nodiscard]] std::optional<double> likely_share() const;
  void settle();
  void narrow();
  [[nodiscard]] const SightPiece* wide_piece(bool by_guess) const;
  void order();
  void look_at_full(Aim aim, double share);
  void settle_touches();
  [[nodiscard]] std::optional<double> unsettled_touch() const;
  void decide_by_search();

  const OpenedTerrain& terrain_;
  const CoarseGround* coarse_;
  SightLine line_;
  MapPoint origin_, way_;  ///< The line's beginning, and from there to its end, grid units.
  Detail full_detail_;
  LevelStars asked_, full_;  ///< Stars of the level of detail, and of the full TIN.
  // The search at hand.
  LevelStars* stars_ = &asked_;
  Aim aim_ = Aim::kVerdict;
  Part part_{0.0, 1.0};   ///< Part of the way; nothing else is looked at.
  LivingFilter filter_;   ///< What is wanted of the page at hand.
  Floor::Recent recent_;  ///< Ends, and parts of the line, share pages.
  double lowest_ = 0.0;   ///< What ends below this height on the page does not matter.
  bool is_cut_ = false;   ///< The budget ended the search.
  double cut_bound_ = 0.0;
  // What all searches have found.
  double most_ = kInfinity;           ///< The smallest clearance is no more.
  double first_hidden_ = 2.0;         ///< Share of the way at which a hidden piece begins; 2: none.
  std::optional<double> open_touch_;  ///< Where the line has one point, which may be a void or not.
  std::vector<double> settled_;       ///< Points of the line at which the full TIN was looked at.
};

}  // namespace ptin
