// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/walk/spot_set.h"

#include <algorithm>
#include <array>

namespace ptin {

namespace {

constexpr std::uint64_t kMostCells = std::uint64_t{1} << 18;
constexpr std::uint64_t kPatchesOfSpot = 64;

}  // namespace

SpotSet::SpotSet(std::span<const Spot> spots, double tolerance)
    : tolerance_(tolerance), single_(spots.size() == 1) {
  GridBox reach;
  for (const Spot& s : spots) {
    reach = united(reach, box_around(s));
  }
  low_x_ = reach.min_x, low_y_ = reach.min_y;
  high_x_ = reach.max_x, high_y_ = reach.max_y;
  if (single_) {
    return;
  }
  const auto cells = [&](int shift) {
    return static_cast<std::uint64_t>(((high_x_ - low_x_) >> shift) + 1) *
           static_cast<std::uint64_t>(((high_y_ - low_y_) >> shift) + 1);
  };
  const std::uint64_t most = std::min<std::uint64_t>(kMostCells, 4 * spots.size() + 4);
  while (cells(cell_shift_) > most) {
    ++cell_shift_;
  }
  mark_patches(spots);
  columns_ = static_cast<std::uint32_t>(((high_x_ - low_x_) >> cell_shift_) + 1);
  rows_ = static_cast<std::uint32_t>(((high_y_ - low_y_) >> cell_shift_) + 1);
  begin_.assign(std::size_t{columns_} * rows_ + 1, 0);
  const auto cell = [&](const Spot& s) {
    return std::size_t{cell_of(s.y >> kSpotBits, low_y_)} * columns_ +
           cell_of(s.x >> kSpotBits, low_x_);
  };
  for (const Spot& s : spots) {
    ++begin_[cell(s) + 1];
  }
  for (std::size_t i = 1; i < begin_.size(); ++i) {
    begin_[i] += begin_[i - 1];
  }
  spots_.resize(spots.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  index_.resize(spots.size());
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const std::uint32_t place = next[cell(spots[i])]++;
    spots_[place] = spots[i];
    index_[place] = static_cast<std::uint32_t>(i);
  }
  sums_.assign(std::size_t{columns_ + 1} * (rows_ + 1), 0);
  for (std::uint32_t row = 0; row < rows_; ++row) {
    const std::size_t first = std::size_t{row} * columns_;
    for (std::uint32_t column = 0; column < columns_; ++column) {
      sums_[std::size_t{row + 1} * (columns_ + 1) + column + 1] =
          spots_below(column + 1, row) + begin_[first + column + 1] - begin_[first];
    }
  }
}

/// Squares are closed: a spot on a side that two of them share lies in both.
void SpotSet::mark_patches(std::span<const Spot> spots) {
  const auto patches = [&](int shift) {
    return static_cast<std::uint64_t>(((high_x_ - low_x_) >> shift) + 1) *
           static_cast<std::uint64_t>(((high_y_ - low_y_) >> shift) + 1);
  };
  while (patches(patch_shift_) > kPatchesOfSpot * spots.size()) {
    ++patch_shift_;
  }
  patch_columns_ = ((high_x_ - low_x_) >> patch_shift_) + 1;
  patches_.assign(patches(patch_shift_) / 64 + 1, 0);
  // The first and the last of the squares that hold a number along one axis.
  const auto squares = [&](std::int64_t below, std::int64_t above, std::int64_t low) {
    const std::int64_t first = std::max<std::int64_t>(above - 1 - low, 0) >> patch_shift_;
    return std::array{first, (below - low) >> patch_shift_};
  };
  for (const Spot& s : spots) {
    const GridBox box = box_around(s);
    for (const std::int64_t row : squares(box.min_y, box.max_y, low_y_)) {
      for (const std::int64_t column : squares(box.min_x, box.max_x, low_x_)) {
        const auto bit = static_cast<std::size_t>(row * patch_columns_ + column);
        patches_[bit / 64] |= std::uint64_t{1} << (bit % 64);
      }
    }
  }
}

/// A cell strictly between the cells of the box's sides lies inside of the box, so one spot in such
/// a cell decides. The spots of the other cells are looked at one by one, row by row.
bool SpotSet::holds_one(const GridBox& b) const noexcept {
  const std::uint32_t left = cell_of(std::max<std::int64_t>(b.min_x, low_x_), low_x_);
  const std::uint32_t right = cell_of(std::min<std::int64_t>(b.max_x, high_x_), low_x_);
  const std::uint32_t bottom = cell_of(std::max<std::int64_t>(b.min_y, low_y_), low_y_);
  const std::uint32_t top = cell_of(std::min<std::int64_t>(b.max_y, high_y_), low_y_);
  if (spots_below(right + 1, top + 1) - spots_below(left, top + 1) ==
      spots_below(right + 1, bottom) - spots_below(left, bottom)) {
    return false;
  }
  if (right > left + 1 && top > bottom + 1 &&
      spots_below(right, top) - spots_below(left + 1, top) !=
          spots_below(right, bottom + 1) - spots_below(left + 1, bottom + 1)) {
    return true;
  }
  for (std::uint32_t row = bottom; row <= top; ++row) {
    const std::size_t first = std::size_t{row} * columns_;
    for (std::uint32_t i = begin_[first + left]; i < begin_[first + right + 1]; ++i) {
      if (contains(b, spots_[i])) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace ptin
