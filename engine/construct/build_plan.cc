// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/build_plan.h"

#include <algorithm>
#include <filesystem>

#include <sys/stat.h>

#include "engine/construct/build.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/process_limits.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

// A thread's, both halves of the build: measured, with some room (bench/results/builds.md).
constexpr double kVerticesPerSecond = 150000.0;

/// Samples of the largest leaf: the last one of a row may be half a side longer than the others.
std::uint64_t samples_of_leaf(const TileTree& tree) {
  TileId last = tree.root();
  while (last.level > 0) {
    last = tree.children(last).back();
  }
  const SampleRange w = tree.window(last);
  const SampleRange first = tree.window({0, 0, 0});
  return static_cast<std::uint64_t>(std::max(w.width, first.width)) *
         static_cast<std::uint64_t>(std::max(w.height, first.height));
}

std::string in_mib(std::uint64_t bytes) { return std::to_string((bytes + kMiB - 1) / kMiB) + "M"; }

/// What the largest piece of work takes beside the memory for reading: a batch of leaves, or the
/// last join of four tiles, which holds as many vertices as a leaf and those of the seams around it
/// and in it, and takes the memory for reading too.
std::uint64_t bytes_of_largest(std::uint64_t leaf_samples, const TileTree& tree,
                               const TileBytes& tile_bytes, std::uint64_t reading) {
  const std::uint64_t leaf =
      std::max(tile_bytes.of_batch(leaf_samples), tile_bytes.of_replay(leaf_samples));
  if (tree.levels() < 3) {  // joined within the batch
    return leaf;
  }
  const SampleRange whole = tree.window(tree.root());
  const auto seams = static_cast<std::uint64_t>(whole.width + whole.height);
  const std::uint64_t join =
      tile_bytes.of_join((leaf_samples + seams) * tile_bytes.pushed_of_vertex);
  return std::max(leaf, join - std::min(join, reading));
}

/// The longest side below the tree's whose tiles fit into `bytes`; 0 when none of 32 or more does.
std::int64_t side_that_fits(std::uint64_t bytes, const TileTree& tree, const TileBytes& tile_bytes,
                            std::uint64_t reading) {
  std::int64_t side = tree.side();
  const auto fits = [&] {  // the last tile of a row may be half a side longer
    const auto longest = static_cast<std::uint64_t>(side + side / 2);
    return bytes_of_largest(longest * longest, tree, tile_bytes, reading) <= bytes;
  };
  while (side >= 32 && (side == tree.side() || !fits())) {
    side -= 16;
  }
  return side >= 32 ? side : 0;
}

/// Threads and the share of the tiles: as many threads as were asked for, or as fit.
void plan_threads(BuildPlan& plan, const TileTree& tree, const PlanRequest& request,
                  bool may_refuse) {
  const TileBytes& tile_bytes = request.tile_bytes;
  const MemoryPlan& memory = request.memory;
  const std::uint64_t present = anonymous_bytes_now();
  const std::uint64_t samples = samples_of_leaf(tree);
  const std::uint64_t one = bytes_of_largest(samples, tree, tile_bytes, memory.gdal_cache);
  plan.memory = memory;
  plan.tile_bytes = tile_bytes;
  plan.threads_wanted =
      request.resources.threads > 0 ? request.resources.threads : allowed_threads();
  plan.threads = plan.threads_wanted;
  std::uint64_t share = memory.for_tiles(present, plan.threads);
  const std::uint64_t batch = std::max(tile_bytes.of_batch(samples), tile_bytes.of_replay(samples));
  const auto fit = [&] {
    return share >= one && share >= batch * static_cast<std::uint64_t>(plan.threads);
  };
  while (plan.threads > 1 && !fit()) {
    share = memory.for_tiles(present, --plan.threads);
  }
  if (share < one && may_refuse) {
    MemoryPlan enough = memory;
    while (enough.for_tiles(present, 1) < one) {
      enough = memory.within(enough.limit + kMiB);
    }
    const std::int64_t side = side_that_fits(share, tree, tile_bytes, memory.gdal_cache);
    throw Error(ErrorCode::resource_exhausted,
                "a tile of " + std::to_string(plan.tile_side) + " samples a side needs " +
                    in_mib(enough.limit) + " of memory in all and the limit is " +
                    in_mib(memory.limit) + "; give --memory " + in_mib(enough.limit) +
                    (side == 0 ? "" : ", or --tile " + std::to_string(side)));
  }
  plan.memory_for_tiles = share;
  plan.memory_expected =
      memory.limit - share +
      std::min(share, std::max(one, batch * static_cast<std::uint64_t>(plan.threads)));
}

std::uint64_t free_in(const std::string& folder) {
  std::error_code failure;
  const std::filesystem::space_info space = std::filesystem::space(folder, failure);
  return failure ? ~std::uint64_t{0} : space.available;
}

bool on_same_disk(const std::string& a, const std::string& b) {
  struct stat first {
  }, second{};
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 &&
         first.st_dev == second.st_dev;
}

/// As much of the output and of temporary files as cannot be there yet must be free.
void require_disk(const BuildPlan& plan, const std::string& output, const std::string& tmp,
                  std::uint64_t least_output, std::uint64_t temporary) {
  const auto require = [&](std::uint64_t needed, std::uint64_t free, const std::string& where) {
    if (needed > free) {
      throw Error(ErrorCode::resource_exhausted,
                  "the build needs up to " + in_mib(needed) + " of disk in " + where + " and " +
                      in_mib(free) +
                      " are free; free some, or name another disk for temporary files by --tmp",
                  output);
    }
  };
  const std::string folder = folder_of(output);
  if (plan.same_disk) {
    require(least_output + temporary, plan.output_free, folder);
  } else {
    require(least_output, plan.output_free, folder);
    require(temporary, plan.temporary_free, tmp);
  }
}

void plan_disk(BuildPlan& plan, const PlanRequest& request) {
  const std::string& output = request.output;
  const BuildResources& resources = request.resources;
  const SourceDisk& source = request.disk;
  const auto vertices = static_cast<double>(plan.vertices);
  plan.output_bytes = static_cast<std::uint64_t>(vertices * source.output_of_vertex) + kMiB;
  const std::uint64_t tiles =
      plan.leaves == 1 ? 0 : static_cast<std::uint64_t>(vertices * source.tiles_of_vertex) + kMiB;
  plan.temporary_bytes = std::max(source.while_reading, source.kept + tiles);
  const std::string folder = folder_of(output);
  const std::string tmp = resources.tmp.empty() ? folder : resources.tmp;
  plan.output_free = free_in(folder);
  plan.temporary_free = free_in(tmp);
  plan.same_disk = on_same_disk(folder, tmp);
  const bool may_be_taken_up = resources.unfinished != Unfinished::kRefuse && !source.is_there &&
                               is_there(Workspace::folder_of(output));
  if (source.may_be_less || may_be_taken_up) {
    return;  // of what is needed much may be on the disk already, or never come
  }
  // With --max-error how much is left out is not known before.
  const std::uint64_t least_output = request.options.max_error > 0.0 ? 0 : plan.output_bytes;
  require_disk(plan, output, tmp, least_output, source.is_there ? tiles : plan.temporary_bytes);
}

}  // namespace

BuildPlan plan_build(const TileTree& tree, const PlanRequest& request) {
  const SampleRange whole = tree.window(tree.root());
  BuildPlan plan;
  plan.tile_side = tree.side();
  plan.leaves = tree.leaves();
  plan.levels = tree.levels();
  plan.vertices =
      static_cast<std::uint64_t>(whole.width) * static_cast<std::uint64_t>(whole.height);
  plan_threads(plan, tree, request, !(request.disk.is_estimate && request.disk.may_be_less));
  plan.is_estimate = request.disk.is_estimate;
  plan_disk(plan, request);
  plan.seconds = static_cast<double>(plan.vertices) / kVerticesPerSecond / plan.threads;
  return plan;
}

}  // namespace ptin
