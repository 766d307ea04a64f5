// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of files, sorted into buckets that leave nothing behind.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/construct/points/point_source.h"
#include "storage/file/file_layer.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/task_runs.h"

namespace ptin {

/// Does all tasks one after the other, each in so many bytes.
inline RunTasks run_told(std::uint64_t memory, const std::stop_token& stop = {},
                         const std::function<void(const StageProgress&)>& told = {}) {
  return test::on_threads(1, memory, stop, told);
}

/// Sorting that is shared out finely, and sorts on disk what does not fit into what it is given.
inline SortSizes small_sorting() {
  SortSizes sizes;
  sizes.range_points = 3000;
  sizes.share_points = 5000;
  sizes.least_memory = 0;
  return sizes;
}

/// The buckets of some files. Their files have no names any more.
inline PointBuckets read_buckets(const std::vector<std::string>& paths,
                                 const SourceOptions& options = {},
                                 std::uint64_t memory = std::uint64_t{1} << 20,
                                 const SortSizes& sizes = {}) {
  const oracle::ScratchFolder folder(oracle::ScratchFolder::Size::kSmall);
  PointSource source(
      paths, options,
      {{FileLayer::system(), folder.path()}, run_told(memory), {}, memory, {}, {}, sizes});
  return source.sort(folder.file("buckets"), true);
}

}  // namespace ptin
