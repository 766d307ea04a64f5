// SPDX-License-Identifier: GPL-3.0-or-later
//
// The predicate of a batch of points: true when the roi of a record holds one of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "engine/query/shape/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// True for records whose roi holds at least one of some spots and whose error is
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
  /// False when no spot lies in the closed box, which is at least one unit wide and high; true when
  /// one does, or may. Cost: a bit or a few for a box of the size of the distance between spots.
  [[nodiscard]] bool may_hold_spot(const GridBox& b) const noexcept {
    if (single_ || !meets(b)) {
      return meets(b);
    }
    // The closed squares along one side that the box shares more with than a line.
    const auto squares = [&](std::int64_t from, std::int64_t to, std::int64_t low,
                             std::int64_t high) {
      const std::int64_t first = (std::max(from, low) - low) >> patch_shift_;
      return std::pair{first, std::max(first, (std::min(to, high) - 1 - low) >> patch_shift_)};
    };
    const auto [left, right] = squares(b.min_x, b.max_x, low_x_, high_x_);
    const auto [bottom, top] = squares(b.min_y, b.max_y, low_y_, high_y_);
    bool is_any = (right - left + 1) * (top - bottom + 1) > kMostPatches;
    for (std::int64_t row = bottom; row <= top && !is_any; ++row) {
      for (std::int64_t column = left; column <= right; ++column) {
        is_any |= has_spot(row, column);
      }
    }
    return is_any;
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

  static constexpr std::int64_t kMostPatches = 8;
  [[nodiscard]] bool has_spot(std::int64_t row, std::int64_t column) const noexcept {
    const auto bit = static_cast<std::size_t>(row * patch_columns_ + column);
    return (patches_[bit / 64] >> (bit % 64) & 1) != 0;
  }
  void mark_patches(std::span<const Spot> spots);

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
  /// A bit for each closed square of 2^patch_shift_ grid units, row by row: a spot lies in it.
  std::vector<std::uint64_t> patches_;
  int patch_shift_ = 0;
  std::int64_t patch_columns_ = 1;
  std::vector<Spot> spots_;           ///< Cell by cell.
  std::vector<std::uint32_t> index_;  ///< Index of each of them among those given.
};

}  // namespace ptin
