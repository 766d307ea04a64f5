// SPDX-License-Identifier: GPL-3.0-or-later
//
// Levels: the heights that isolines are asked for, as codes, and the one rule that says on which
// side of a level a vertex lies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/geometry/height.h"
#include "engine/query/select/predicate.h"

namespace ptin {

/// Most levels that one question may have.
inline constexpr std::size_t kMostLevels = 65536;

/// Ascending numbers, the steps, that tell how many of them lie at or below a value. A table says
/// where to begin, and a few comparisons finish: every record and vertex asks. Threads: immutable.
class Ladder {
 public:
  Ladder() = default;
  /// @param steps  Ascending, each once, finite; not empty.
  explicit Ladder(std::vector<double> steps);
  [[nodiscard]] const std::vector<double>& steps() const noexcept { return steps_; }
  /// How many steps are at most v.
  [[nodiscard]] std::uint32_t at_or_below(double v) const noexcept {
    std::uint32_t i = first_[slot(v)];
    while (i < steps_.size() && steps_[i] <= v) {
      ++i;
    }
    return i;
  }

 private:
  /// Never falls while v grows, under rounding too; so a step in a smaller slot than v's is below
  /// v.
  [[nodiscard]] std::size_t slot(double v) const noexcept {
    const double place = (v - steps_.front()) * per_slot_;
    const auto last = static_cast<double>(first_.size() - 1);
    return place > 0 ? static_cast<std::size_t>(place < last ? place : last) : 0;
  }
  std::vector<double> steps_;
  std::vector<std::uint32_t> first_;  ///< For each slot how many steps lie in smaller slots.
  double per_slot_ = 0;
};

/// Levels in ascending order, each once.
///
/// The rule: a vertex at a level counts as above it. So an edge crosses a level when one end is
/// below and the other at or above it, a triangle has no piece of a level's isoline or exactly one,
/// and isolines never end but at borders (symbolic perturbation: every vertex exactly at a level is
/// lifted by less than anything).
///
/// Levels are compared as codes. Where heights are stored as integers, a level within eight units
/// in the last place of a stored height is that height: 254.97 is the vertex height 25497 x 0.01,
/// though the product is another double.
/// Threads: immutable.
class LevelSet {
 public:
  /// @param levels  Heights in the height's unit, in any order; repetitions are dropped.
  /// @throws Error invalid_argument  no level, one that is not finite, or more than kMostLevels
  LevelSet(const std::vector<double>& levels, const HeightEncoding& encoding);

  [[nodiscard]] std::size_t size() const noexcept { return codes_->steps().size(); }
  [[nodiscard]] double height(std::size_t level) const noexcept { return heights_[level]; }
  [[nodiscard]] double code(std::size_t level) const noexcept { return codes_->steps()[level]; }
  [[nodiscard]] const std::vector<double>& heights() const noexcept { return heights_; }
  /// The least ordered height (storage/page_columns.h) that is above a level; 2^32 where none is.
  [[nodiscard]] std::uint64_t least_above(std::size_t level) const noexcept {
    return least_above_[level];
  }
  /// The same of all levels, ascending.
  [[nodiscard]] std::span<const std::uint64_t> least_above() const noexcept { return least_above_; }

  /// The band of a height: how many levels lie at or below it. A vertex is above level i exactly
  /// when its band is larger than i, so a surface triangle crosses the levels from its smallest
  /// band up to, not including, its largest.
  [[nodiscard]] std::uint32_t band_of(double code) const noexcept {
    return codes_->at_or_below(code);
  }

  /// True for records whose surface some level may cross: lowest height < level <= highest.
  /// Monotone. A record left out lies on one side of every level, so no isoline passes through it.
  [[nodiscard]] PredicatePtr crossing() const;

 private:
  std::vector<double> heights_;
  std::shared_ptr<const Ladder> codes_;
  std::vector<std::uint64_t> least_above_;
};

/// The levels base + n * interval within [low, high], n an integer, as gdal_contour -i has them.
/// None when low > high, as where all is void.
/// @throws Error invalid_argument  interval not positive, a value not finite, |n| > 2^53, or more
///                                 than kMostLevels levels
[[nodiscard]] std::vector<double> levels_at(double interval, double base, double low, double high);

}  // namespace ptin
