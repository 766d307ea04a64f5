// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the tasks that sort a source of points are given: its grid, its lines, and how it is shared
// out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/grid/point_grid.h"
#include "engine/construct/grid/point_order.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/lines/edges_file.h"
#include "engine/construct/lines/fixed_edges.h"
#include "engine/construct/points/point_reading.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// Constants by which sorting is shared out. Tests choose smaller ones; results do not depend on them.
struct SortSizes {
  /// Points of a range of the curve: so many are sorted in memory at once. A large source has
  /// most_ranges ranges of more points each, which are sorted on disk where they have to be.
  std::uint64_t range_points = std::uint64_t{1} << 17;
  std::uint64_t most_ranges = 256;
  /// Points that one task shares out among the ranges, and how many such tasks there are at most.
  std::uint64_t share_points = std::uint64_t{1} << 18;
  std::uint64_t most_shares = 192;
  /// A task that sorts takes so much memory even where its part is less, bytes.
  std::uint64_t least_memory = std::uint64_t{4} << 20;
  std::uint64_t bucket_points = 1024;  ///< The least of a bucket.
  std::uint64_t most_buckets = std::uint64_t{1} << 20;
};

/// How a source of points is sorted. Ranges are intervals of places along the curve: of range i from
/// splitters[i - 1] on, up to below splitters[i].
struct SortPlan {
  PointGrid grid;
  PointMerge rule = PointMerge::kMean;
  std::uint64_t points = 0;         ///< Points of all spools.
  std::uint64_t shares = 1;         ///< Tasks that share out.
  std::uint64_t block_records = 0;  ///< Records that are written to a range at a time.
  std::uint64_t bucket_points = 0;  ///< Points of a bucket; the last one of a range may have fewer.
  std::uint64_t least_memory = 0;   ///< As SortSizes.
  std::string buckets;  ///< The path of the file of a range's buckets, but for its number.
  std::vector<std::uint64_t> splitters;  ///< Ascending.
  std::vector<PointReading::Spool> spools;
  FixedEdges fixed;

  [[nodiscard]] bool is_numbered() const noexcept { return rule == PointMerge::kFirst; }
  [[nodiscard]] std::size_t ranges() const noexcept { return splitters.size() + 1; }
  [[nodiscard]] std::size_t range_of(std::uint64_t key) const noexcept;
  [[nodiscard]] PointOrder order() const noexcept { return PointOrder(grid.largest()); }
  [[nodiscard]] std::string buckets_of(std::size_t range) const {
    return buckets + "-" + std::to_string(range);
  }
};
template <class File, MaybeConst<SortPlan> Plan>
void serialize(File& file, Plan& p) {
  file.values(p.grid, p.rule, p.points, p.shares, p.block_records, p.bucket_points, p.least_memory,
              p.buckets, p.splitters, p.spools, p.fixed);
}

/// The plan of a source. It depends on the points, the lines and the sizes alone.
[[nodiscard]] SortPlan plan_sorting(const PointReading& reading, const PointGrid& grid,
                                    FixedEdges fixed, PointMerge rule, std::string buckets,
                                    const SortSizes& sizes = {});

/// The ends of `ranges` ranges of about equal weight but for the last; fewer where many points fall
/// together. REQUIRES: ranges >= 1.
struct WeightedKey {
  std::uint64_t key = 0, weight = 1;
};
[[nodiscard]] std::vector<std::uint64_t> split(std::vector<WeightedKey> keys, std::uint64_t ranges);

}  // namespace ptin
