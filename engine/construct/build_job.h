// SPDX-License-Identifier: GPL-3.0-or-later
//
// What builds of every kind of source share: the job, and the work in a folder that can be resumed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/build.h"
#include "engine/construct/build_plan.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/hierarchy/tile_bytes.h"
#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/points/point_count.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin::build_internal {

/// What a leaf of points or triangles takes: its triangulation by CGAL goes before its collapses
/// begin, its copy of the full surface stays.
inline constexpr TileBytes kPointTileBytes{.replay_of_sample = 560};

/// One call of build(): what it was asked, and what it reports.
struct Job {
  const std::vector<std::string>& inputs;
  const std::string& output;
  const BuildOptions& options;
  const BuildResources& resources;
  BuildReport report;
  /// While nothing is done that a resumed build would not do again: an error then leaves no folder.
  bool begins_anew = false;

  [[nodiscard]] FileLayer& files() const;
  [[nodiscard]] std::uint64_t memory() const;
  /// A stage of the caller's progress.
  [[nodiscard]] std::function<void(std::uint64_t done, std::uint64_t total)> stage(
      const char* name) const;
  [[nodiscard]] SourceOptions source_options() const;
};

/// What a build works on, of whatever kind its source is.
struct Terrain {
  TerrainFrame frame;
  MeasureUnits units;
  TileTree tree;
  std::function<LeafStarter()> make_starter;  ///< Called once for each thread.
};

/// What is being handled, as an Error: what libraries throw, and the caller's own functions.
/// To be called while an exception is handled.
[[nodiscard]] Error error_in_flight();

/// The same error, and that the work in `folder` can be gone on with.
[[nodiscard]] Error told_as_kept(const Error& error, const std::string& folder);

/// What decides the bytes of the output, that its inputs are still the ones it began with, and the
/// program, whose temporary files another version may not understand. To be taken before anything
/// is read: a file that is replaced meanwhile is another one then.
[[nodiscard]] nlohmann::json fingerprint(const Job& job);

/// Opens the job's workspace, works in it, and removes it, or keeps it where there is work to go on
/// with: the error says so then. @throws Error as Workspace, and what `work` throws
void in_workspace(Job& job, const nlohmann::json& fingerprint,
                  const std::function<void(Workspace&)>& work);

/// Collapses, tightens and publishes; or sees that an interrupted build had done all of that.
void build_tiles(Workspace& workspace, Job& job, const Terrain& terrain, const BuildPlan& plan);

/// Says what is expected before anything but headers and first lines is read, and refuses what
/// cannot do. With points that may be left out it is no reason to refuse.
/// @param disk_of  What the source takes.
/// @throws Error as count_points() and plan_build()
void announce(const Job& job, const std::function<SourceDisk(const PointCount&)>& disk_of);

/// Of a source that is sorted on disk: the index that an interrupted build noted under `key`; none
/// where it had not got so far.
[[nodiscard]] std::optional<ArrayFileFacts> kept_index(const Workspace& workspace,
                                                       const std::string& key);
/// Notes it, so that what it speaks of is never read again. @throws Error io_error
void note_index(Workspace& workspace, const std::string& key, const ArrayFileFacts& index);
/// Plans the tiles of such a source, and tells the caller. @throws Error as plan_build()
[[nodiscard]] BuildPlan plan_sorted(const Job& job, const TileTree& tree, SourceDisk disk);

/// Points, sorted on disk (point_buckets.h); over tiles.
void build_points(Job& job);
/// Somebody else's triangles, likewise (tin_source.h).
void build_tin(Job& job);

}  // namespace ptin::build_internal
