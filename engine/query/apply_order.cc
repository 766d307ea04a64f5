// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/apply_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "engine/query/refinement_internal.h"

namespace ptin {

namespace {

constexpr std::size_t kSplitsInCell = 4096;
constexpr std::uint32_t kMostDepth = 8;

/// Every second bit of the lower 16.
constexpr std::uint32_t spread(std::uint32_t v) noexcept {
  v = (v | (v << 8)) & 0x00FF00FFU;
  v = (v | (v << 4)) & 0x0F0F0F0FU;
  v = (v | (v << 2)) & 0x33333333U;
  return (v | (v << 1)) & 0x55555555U;
}

/// A quadtree over where most splits are. What lies outside is moved to its border: that keeps a
/// box within a larger one.
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

  /// Numbers below this.
  [[nodiscard]] std::size_t numbers() const noexcept {
    return (std::size_t{16} << (2 * depth_)) + 1;
  }
  /// The number of the smallest cell that holds a box; above those of the cells that hold it.
  [[nodiscard]] std::uint32_t number_of(const GridBox& box) const noexcept {
    const std::uint32_t low_x = column(box.min_x, origin_x_);
    const std::uint32_t low_y = column(box.min_y, origin_y_);
    const std::uint32_t differ =
        (low_x ^ column(box.max_x, origin_x_)) | (low_y ^ column(box.max_y, origin_y_));
    const auto above = static_cast<std::uint32_t>(std::bit_width(differ));
    const std::uint32_t first = (spread(low_x >> above) | (spread(low_y >> above) << 1))
                                << (2 * above);
    return (first << 4) | (depth_ - above);
  }

 private:
  /// From the quartiles of a sample: the middle half in x and y holds about a quarter of the
  /// splits, however far the others are spread.
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

}  // namespace

std::vector<std::uint32_t> places_of(std::span<const PendingSplit> splits) {
  RankOrder ranks(splits);
  std::vector<std::uint32_t> places(splits.size());
  for (std::size_t i = 0; i < splits.size(); ++i) {
    places[i] = ranks.take(splits[i].rank);
  }
  if (splits.size() <= kSplitsInCell) {
    return places;
  }
  const Cells cells(splits);
  std::vector<std::uint32_t> cell(splits.size());  // in the order by rank
  std::vector<std::uint32_t> next(cells.numbers(), 0);
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const std::uint32_t number = cells.number_of(splits[i].roi);
    cell[places[i]] = number;
    ++next[number + 1];
  }
  for (std::size_t i = 1; i < next.size(); ++i) {
    next[i] += next[i - 1];
  }
  for (std::uint32_t& c : cell) {
    c = next[c]++;
  }
  for (std::uint32_t& place : places) {
    place = cell[place];
  }
  return places;
}

}  // namespace ptin
