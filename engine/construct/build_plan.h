// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build expects to need, said before the work starts.
#pragma once

#include <cstdint>
#include <string>

#include "engine/construct/grid/source_disk.h"
#include "engine/construct/hierarchy/tile_bytes.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin {

struct BuildOptions;
struct BuildResources;

/// Bytes and counts, mostly upper bounds by measurement.
struct BuildPlan {
  std::int64_t tile_side = 0;  ///< Grid units along a leaf of the tree of tiles.
  std::uint64_t leaves = 0;
  int levels = 0;              ///< Levels of the tree of tiles, leaves included.
  std::uint64_t vertices = 0;  ///< Vertices of the full TIN, at most.
  MemoryPlan memory;
  std::uint64_t memory_expected = 0;   ///< Bytes of anonymous memory, at most, by estimate.
  std::uint64_t memory_for_tiles = 0;  ///< Share of `memory.limit` for all tiles in work.
  TileBytes tile_bytes;                ///< What each kind of work takes of that.
  int threads_wanted = 1;              ///< Asked for, or allowed_threads().
  int threads = 1;                     ///< As many of these as the memory holds tiles for.
  std::uint64_t temporary_bytes = 0;   ///< Disk, at most, beside the output.
  std::uint64_t output_bytes = 0;      ///< At most.
  std::uint64_t temporary_free = 0, output_free = 0;  ///< Free bytes in the two folders.
  bool same_disk = true;                              ///< Both folders are on one file system.
  double seconds = 0.0;                               ///< Roughly.
  /// True when `vertices` is an estimate: points are not counted yet, so as many are taken as their
  /// files may hold; or tiles of points are taken to be full.
  bool is_estimate = false;
};

/// What a plan is made for. Borrows what it names for the call.
struct PlanRequest {
  const std::string& output;
  const BuildOptions& options;
  const BuildResources& resources;
  const MemoryPlan& memory;
  TileBytes tile_bytes;
  SourceDisk disk;
};

/// @param tree  The tree of the terrain's tiles.
/// @throws Error resource_exhausted  one tile does not fit into the memory (names the --memory and
///                                   the --tile that would), or the disk has less free than needed
[[nodiscard]] BuildPlan plan_build(const TileTree& tree, const PlanRequest& request);

}  // namespace ptin
