// SPDX-License-Identifier: GPL-3.0-or-later
//
// The points of one range of the curve: sorted, merged where they fall together, and put in buckets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/construct/grid/height_finder.h"
#include "engine/construct/points/point_files.h"
#include "engine/construct/points/sort_plan.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tasks/task.h"
#include "engine/geometry/box.h"
#include "engine/geometry/convex_hull.h"

namespace ptin {

/// What the buckets of a range are, beside their points. Joined over all ranges, it is what one range
/// of all points would be.
struct RangeIndex {
  std::uint64_t points = 0;           ///< Distinct positions.
  double largest_shift_height = 0.0;  ///< As GridVertex has heights.
  HeightFinder heights;
  std::vector<GridPoint> hull;           ///< Its corners.
  std::vector<GridBox> boxes;            ///< Boxes of the buckets.
  std::vector<std::uint64_t> ends;       ///< Where each bucket ends in the file of the range.
  std::vector<std::uint64_t> checksums;  ///< Checksums of the buckets.
};

template <class File, MaybeConst<RangeIndex> Index>
void serialize(File& file, Index& i) {
  file.values(i.points, i.largest_shift_height, i.heights, i.hull, i.boxes, i.ends, i.checksums);
}

/// Sorts the range of the task's number of what was shared out, and writes its buckets to
/// plan.buckets_of(), and
/// their index to a file of its own.
/// Memory: task.bytes, or plan.least_memory where that is more. Disk: where that is too little, as
/// much as the records of the range take, once more.
/// @param shares  The facts of all shares.
/// @return  The facts of the index.
/// @throws Error corruption, not_found, io_error, resource_exhausted, cancelled
[[nodiscard]] ArrayFileFacts sort_range(const SortPlan& plan,
                                        const std::vector<ArrayFileFacts>& shares,
                                        const PointFiles& files, const Task& task);

/// @throws Error corruption, not_found, io_error
[[nodiscard]] RangeIndex index_of_range(const PointFiles& files, std::size_t range,
                                        const ArrayFileFacts& facts);

}  // namespace ptin
