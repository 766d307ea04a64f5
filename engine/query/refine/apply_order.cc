// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/refine/apply_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "engine/geometry/morton.h"
#include "engine/query/refine/split_site.h"

namespace ptin {

namespace {

constexpr std::size_t kSplitsInCell = 4096;
constexpr std::uint32_t kMostDepth = 8;

/// spread_bits() of every column of cells: to work one out takes ten times as long.
constexpr auto kSpreadColumns = [] {
  std::array<std::uint32_t, std::size_t{2} << kMostDepth> spread{};
  for (std::uint32_t i = 0; i < spread.size(); ++i) {
    spread[i] = static_cast<std::uint32_t>(spread_bits(i));
  }
  return spread;
}();

/// A quadtree over the square where most splits are. A box that reaches beyond the square is
/// clamped to it, so a box within another one stays within it.
class Cells {
 public:
  explicit Cells(std::span<const PendingSplit> splits) {
    while (depth_ < kMostDepth && (splits.size() >> (2 * depth_)) > kSplitsInCell) {
      ++depth_;
    }
    if (depth_ != 0) {
      ++depth_;  // the middle half of the splits takes about half of each side
      set_frame(splits);
    }
  }

  /// Few splits are one cell.
  [[nodiscard]] bool is_one() const noexcept { return depth_ == 0; }
  /// Cell numbers are below this.
  [[nodiscard]] std::size_t numbers() const noexcept { return std::size_t{16} << (2 * depth_); }
  /// The number of the smallest cell that holds a box, larger than the numbers of the cells above
  /// that cell.
  [[nodiscard]] std::uint32_t number_of(const GridBox& box) const noexcept {
    const std::uint32_t low_x = column(box.min_x, origin_x_);
    const std::uint32_t low_y = column(box.min_y, origin_y_);
    const std::uint32_t differ =
        (low_x ^ column(box.max_x, origin_x_)) | (low_y ^ column(box.max_y, origin_y_));
    const auto above = static_cast<std::uint32_t>(std::bit_width(differ));
    const std::uint32_t first =
        (kSpreadColumns[low_x >> above] | kSpreadColumns[low_y >> above] << 1) << (2 * above);
    return (first << 4) | (depth_ - above);
  }

 private:
  /// Places the square by the quartiles of a sample: the middle half in x and y holds about a
  /// quarter of the splits, however far the others are spread.
  void set_frame(std::span<const PendingSplit> splits) {
    constexpr std::size_t kSample = 256;
    std::array<std::int32_t, kSample> x{};
    std::array<std::int32_t, kSample> y{};
    for (std::size_t i = 0; i < kSample; ++i) {
      const GridPoint p = point_of(splits[i * (splits.size() / kSample)].u);
      x[i] = p.x;
      y[i] = p.y;
    }
    std::sort(x.begin(), x.end());
    std::sort(y.begin(), y.end());
    const std::int64_t middle = std::max(std::int64_t{x[3 * kSample / 4]} - x[kSample / 4],
                                         std::int64_t{y[3 * kSample / 4]} - y[kSample / 4]);
    const auto side = static_cast<std::uint64_t>(std::max<std::int64_t>(4 * middle, 1));
    while ((side >> shift_) >> depth_ != 0) {
      ++shift_;
    }
    const std::int64_t half = (std::int64_t{1} << (shift_ + depth_)) / 2;
    origin_x_ = x[kSample / 2] - half;
    origin_y_ = y[kSample / 2] - half;
  }

  [[nodiscard]] std::uint32_t column(std::int32_t v, std::int64_t origin) const noexcept {
    const std::int64_t last = (std::int64_t{1} << depth_) - 1;
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>((v - origin) >> shift_, 0, last));
  }

  std::uint32_t depth_ = 0;
  std::uint32_t shift_ = 0;
  std::int64_t origin_x_ = 0, origin_y_ = 0;
};

/// What a split is sorted by. Splits take 64 bytes each, so they are looked at once.
struct SortedBy {
  std::uint32_t cell;
  std::uint16_t rank;
};
/// A split on its way through the two sorts.
struct Sorted {
  std::uint32_t split, cell;
};

/// Turns the counts of the cells into the places where their splits begin.
void begin_each(std::vector<std::uint32_t>& next) {
  std::uint32_t before = 0;
  for (std::uint32_t& n : next) {
    before += std::exchange(n, before);
  }
}

}  // namespace

std::vector<std::uint32_t> order_of(std::span<const PendingSplit> splits) {
  const Cells cells(splits);
  std::vector<std::uint32_t> order(splits.size());
  if (cells.is_one()) {
    RankOrder ranks(splits);
    for (std::uint32_t i = 0; i < splits.size(); ++i) {
      order[ranks.take(splits[i].rank)] = i;
    }
    return order;
  }
  RankOrder ranks;
  std::vector<SortedBy> by(splits.size());
  std::vector<std::uint32_t> next(cells.numbers(), 0);
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const std::uint32_t cell = cells.number_of(splits[i].roi);
    by[i] = {cell, splits[i].rank};
    ++next[cell];
    ranks.count(splits[i].rank);
  }
  ranks.begin();
  std::vector<Sorted> by_rank(splits.size());
  for (std::uint32_t i = 0; i < splits.size(); ++i) {
    by_rank[ranks.take(by[i].rank)] = {i, by[i].cell};
  }
  begin_each(next);
  for (const Sorted& s : by_rank) {
    order[next[s.cell]++] = s.split;
  }
  return order;
}

}  // namespace ptin
