// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/star_choice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// Takes the sides of the roi of a few records.
void take_sides(PageRun& run, std::uint64_t records) {
  for (const PageColumn c :
       {PageColumn::kWest, PageColumn::kSouth, PageColumn::kEast, PageColumn::kNorth}) {
    run.take_some(c, records);
  }
}

/// The records of a run whose roi meets a box: the roi is looked at where u lies outside of the box,
/// but no farther from it than any roi of the page reaches.
std::uint64_t near_box(const RecordPage& page, const GridBox& box, PageRun& run) {
  const auto reach = [&](PageColumn c) {
    return static_cast<std::int64_t>((std::uint64_t{1} << page.columns().width(c)) - 1);
  };
  const std::int64_t low_x = box.min_x - reach(PageColumn::kEast);
  const std::int64_t high_x = box.max_x + reach(PageColumn::kWest);
  const std::int64_t low_y = box.min_y - reach(PageColumn::kNorth);
  const std::int64_t high_y = box.max_y + reach(PageColumn::kSouth);
  const std::uint64_t* const xs = run.take(PageColumn::kX);
  const std::uint64_t* const ys = run.take(PageColumn::kY);
  std::uint64_t near = 0;
  std::uint64_t within = 0;  // u lies in the box
  for (std::uint32_t k = 0; k < run.count(); ++k) {
    const auto x = static_cast<std::int64_t>(xs[k]);
    const auto y = static_cast<std::int64_t>(ys[k]);
    const bool is_near = (low_x <= x) & (x <= high_x) & (low_y <= y) & (y <= high_y);
    const bool is_within =
        (box.min_x <= x) & (x <= box.max_x) & (box.min_y <= y) & (y <= box.max_y);
    near |= std::uint64_t{is_near} << k;
    within |= std::uint64_t{is_within} << k;
  }
  take_sides(run, near & ~within);
  for (std::uint64_t left = near & ~within; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    near ^= std::uint64_t{!meets(run.roi(k), box)} << k;
  }
  return near;
}

/// Those of wanted records whose error is above what no star is of.
std::uint64_t above(std::int64_t below, std::uint64_t wanted, PageRun& run) {
  run.take_some(PageColumn::kError, wanted);
  for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    wanted ^= std::uint64_t{static_cast<std::int64_t>(run.error_bits(k)) <= below} << k;
  }
  return wanted;
}

/// Those of wanted records whose heights may be those that are asked for.
std::uint64_t with_heights(const Interval& asked, std::uint64_t wanted, PageRun& run) {
  run.take_heights(wanted);
  run.take_some(PageColumn::kFlags, wanted);
  for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    wanted ^= std::uint64_t{!meets(run.codes(k), asked)} << k;
  }
  return wanted;
}

/// Those of wanted records within whose heights a step lies. A record without heights spans none.
std::uint64_t with_steps(std::span<const std::uint64_t> steps, std::uint64_t wanted, PageRun& run) {
  run.take_heights(wanted);
  std::array<std::uint64_t, PageRun::kMost> low, high;  // NOLINT: written before read
  std::uint64_t least = UINT64_MAX;
  std::uint64_t most = 0;
  for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    const OrderedInterval heights = run.heights(k);
    low[k] = heights.low;
    high[k] = heights.high;
    least = std::min(least, low[k]);
    most = std::max(most, high[k]);
  }
  std::uint64_t crossed = 0;
  for (const std::uint64_t step : steps_within(steps, least, most)) {
    for (std::uint64_t left = wanted & ~crossed; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      crossed |= static_cast<std::uint64_t>((low[k] < step) & (step <= high[k])) << k;
    }
  }
  return crossed;
}

}  // namespace

std::uint64_t chosen_stars(const RecordPage& page, const LivingFilter& filter, bool is_within,
                           PageRun& run) {
  std::uint64_t wanted = is_within ? ~std::uint64_t{0} >> (PageRun::kMost - run.count())
                                   : near_box(page, filter.box, run);
  // Heights of a local page are looked up, so the other conditions come first.
  const std::int64_t below = most_error_below(filter);
  if (wanted != 0 && below >= 0) {
    wanted = above(below, wanted, run);
  }
  if (filter.each != nullptr) {
    run.take_some(PageColumn::kX, wanted);
    run.take_some(PageColumn::kY, wanted);
    take_sides(run, wanted);
  }
  for (std::uint64_t left = filter.each != nullptr ? wanted : 0; left != 0; left &= left - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
    const StarAttributes star{run.roi(k), {}, kInfinity, -kInfinity};
    wanted ^= std::uint64_t{!filter.each->may_hold(star)} << k;
  }
  if (wanted != 0 && filter.heights != kAllHeights) {
    wanted = with_heights(filter.heights, wanted, run);
  }
  if (wanted != 0 && !filter.steps.empty()) {
    wanted = with_steps(filter.steps, wanted, run);
  }
  return wanted;
}

}  // namespace ptin
