// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of a batch of points: true when the region of influence holds one of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/query/walk/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// True for records whose region of influence holds at least one of some spots and whose error is
/// above a tolerance. Exact, so monotone. Threads: immutable.
class SpotSet final : public AttributePredicate {
 public:
  /// @param spots      At least one, all on the grid. Copied.
  /// @param tolerance  Records of an error at or below it are left out; negative: none are.
  /// Cost: O(spots).
  SpotSet(std::span<const Spot> spots, double tolerance);

  /// Cost: constant for a box much larger than the distance between spots; otherwise the number of
  /// spots near the box.
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return a.error > tolerance_ && holds_spot(a.roi);
  }
  [[nodiscard]] bool is_single() const noexcept { return single_; }
  /// Whether a spot lies in the closed box. Cost: as holds().
  [[nodiscard]] bool holds_spot(const GridBox& b) const noexcept {
    return meets(b) && (single_ || holds_one(b));
  }
  /// Calls visit(index) for each spot in the closed box, by its index among those given. Cost: the
  /// cells that the box meets, and the spots in them.
  template <class Visit>
  void for_each_in(const GridBox& b, const Visit& visit) const {
    if (!meets(b)) {
      return;
    }
    if (single_) {
      visit(std::size_t{0});
      return;
    }
    const std::uint32_t left = cell_of(std::max<std::int64_t>(b.min_x, low_x_), low_x_);
    const std::uint32_t right = cell_of(std::min<std::int64_t>(b.max_x, high_x_), low_x_);
    const std::uint32_t bottom = cell_of(std::max<std::int64_t>(b.min_y, low_y_), low_y_);
    const std::uint32_t top = cell_of(std::min<std::int64_t>(b.max_y, high_y_), low_y_);
    for (std::uint32_t row = bottom; row <= top; ++row) {
      const std::size_t first = std::size_t{row} * columns_;
      for (std::uint32_t i = begin_[first + left]; i < begin_[first + right + 1]; ++i) {
        if (contains(b, spots_[i])) {
          visit(std::size_t{index_[i]});
        }
      }
    }
  }
  [[nodiscard]] GridBox reach() const noexcept override {  // spots lie on the grid
    return {static_cast<std::int32_t>(low_x_), static_cast<std::int32_t>(low_y_),
            static_cast<std::int32_t>(high_x_), static_cast<std::int32_t>(high_y_)};
  }

 private:
  [[nodiscard]] bool meets(const GridBox& b) const noexcept {
    // All spots lie in the box [low_, high_], the smallest grid box around them. A box that holds
    // it holds a spot. A box that only meets it may hold one of several spots, but not a single
    // spot.
    return b.min_x <= low_x_ && high_x_ <= b.max_x && b.min_y <= low_y_ && high_y_ <= b.max_y
               ? true
               : !single_ && b.min_x <= high_x_ && low_x_ <= b.max_x && b.min_y <= high_y_ &&
                     low_y_ <= b.max_y;
  }
  [[nodiscard]] bool holds_one(const GridBox& b) const noexcept;
  [[nodiscard]] std::uint32_t cell_of(std::int64_t grid, std::int64_t low) const noexcept {
    return static_cast<std::uint32_t>((grid - low) >> cell_shift_);
  }
  [[nodiscard]] std::uint32_t spots_below(std::uint32_t column, std::uint32_t row) const noexcept {
    return sums_[std::size_t{row} * (columns_ + 1) + column];
  }

  double tolerance_;
  bool single_;
  std::int64_t low_x_, low_y_, high_x_, high_y_;  ///< Smallest grid box around all spots.
  int cell_shift_ = 0;                            ///< A cell is 2^shift grid units wide.
  std::uint32_t columns_ = 1, rows_ = 1;
  /// Entry (column, row) counts the spots in cells of smaller column and row:
  /// (columns + 1) x (rows + 1) entries, row by row.
  std::vector<std::uint32_t> sums_;
  /// First spot of each cell in spots_, row by row; one more at the end.
  std::vector<std::uint32_t> begin_;
  std::vector<Spot> spots_;           ///< Cell by cell.
  std::vector<std::uint32_t> index_;  ///< Of each of them among those given.
};

}  // namespace ptin
