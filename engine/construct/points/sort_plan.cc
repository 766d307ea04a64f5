// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/sort_plan.h"

#include <algorithm>
#include <utility>

#include "engine/construct/points/point_spool.h"

namespace ptin {

namespace {

/// The records that wait to be written to all ranges together, and the fewest and most of one.
constexpr std::uint64_t kWaiting = std::uint64_t{1} << 18;
constexpr std::uint64_t kFewestWaiting = 1024, kMostWaiting = 4096;

}  // namespace

std::size_t SortPlan::range_of(std::uint64_t key) const noexcept {
  return static_cast<std::size_t>(std::upper_bound(splitters.begin(), splitters.end(), key) -
                                  splitters.begin());
}

std::vector<std::uint64_t> split(std::vector<WeightedKey> keys, std::uint64_t ranges) {
  std::sort(keys.begin(), keys.end(),
            [](const WeightedKey& a, const WeightedKey& b) { return a.key < b.key; });
  std::uint64_t all = 0;
  for (const WeightedKey& k : keys) {
    all += k.weight;
  }
  const double share = static_cast<double>(all) / static_cast<double>(ranges);
  std::vector<std::uint64_t> splitters;
  std::uint64_t before = 0;
  double next = share;
  for (const WeightedKey& k : keys) {
    if (static_cast<double>(before) >= next && splitters.size() + 1 < ranges &&
        (splitters.empty() ? k.key > 0 : k.key > splitters.back())) {
      splitters.push_back(k.key);
      while (next <= static_cast<double>(before)) {
        next += share;
      }
    }
    before += k.weight;
  }
  return splitters;
}

SortPlan plan_sorting(const PointReading& reading, const PointGrid& grid, FixedEdges fixed,
                      PointMerge rule, std::string buckets, const SortSizes& sizes) {
  SortPlan plan;
  plan.grid = grid;
  plan.rule = rule;
  plan.buckets = std::move(buckets);
  plan.spools = reading.spools;
  plan.fixed = std::move(fixed);
  plan.least_memory = sizes.least_memory;
  plan.points = reading.scan.points();
  const PointOrder order = plan.order();
  std::vector<WeightedKey> keys;
  keys.reserve(reading.samples.size());
  for (const PointReading::Sample& s : reading.samples) {
    const SourcePoint p{{s.point.x, s.point.x_decimals}, {s.point.y, s.point.y_decimals}, {}};
    keys.push_back({order.key(grid.position(p)), s.weight});
  }
  plan.splitters =
      split(std::move(keys),
            std::clamp<std::uint64_t>(plan.points / sizes.range_points, 1, sizes.most_ranges));
  std::uint64_t blocks = 0;
  for (const PointReading::Spool& spool : plan.spools) {
    blocks += spool_blocks(spool.points);
  }
  plan.shares =
      std::clamp<std::uint64_t>(plan.points / sizes.share_points, 1,
                                std::max<std::uint64_t>(std::min(sizes.most_shares, blocks), 1));
  plan.block_records = std::clamp(kWaiting / plan.ranges(), kFewestWaiting, kMostWaiting);
  plan.bucket_points = sizes.bucket_points;
  while ((plan.points + plan.bucket_points - 1) / plan.bucket_points > sizes.most_buckets) {
    plan.bucket_points *= 2;
  }
  return plan;
}

}  // namespace ptin
