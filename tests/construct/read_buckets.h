// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of files, sorted into buckets that leave nothing behind.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_stage.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/construct/points/point_source.h"
#include "storage/file/file_layer.h"
#include "tests/construct/made_raster.h"

namespace ptin {

using ToldOfPoints = std::function<void(const char* stage, std::uint64_t, std::uint64_t)>;

/// Does the tasks of all stages one after the other, each in so many bytes.
inline RunStage run_told(std::uint64_t memory, const std::stop_token& stop = {},
                         const ToldOfPoints& told = {}) {
  return [=](const SourceStage& stage, StageWorker& worker) {
    std::vector<std::string> results;
    for (std::size_t i = 0; i < stage.sizes.size(); ++i) {
      const auto progress = [&](std::uint64_t done) {
        if (told) {
          told(stage.name.c_str(), done, stage.sizes[i]);
        }
      };
      results.push_back(worker.run({stage.name, i, stage.facts, memory, stop, progress}));
    }
    return results;
  };
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
