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
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/construct/hierarchy/hierarchy.h"
#include "engine/construct/hierarchy/tile_bytes.h"
#include "engine/construct/hierarchy/tile_collapse.h"
#include "engine/construct/points/point_count.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tile/tile_tree.h"

namespace ptin::build_internal {

/// What the tiles of a source take. A leaf of points or triangles takes more in its replay than one
/// of a raster: its triangulation by CGAL goes before its collapses begin, but its copy of the full
/// surface stays.
[[nodiscard]] TileBytes tile_bytes_of(InputKind kind) noexcept;

/// One call of build(): what it was asked, and what it reports.
struct Job {
  const std::vector<std::string>& inputs;
  const std::string& output;
  const BuildOptions& options;
  const BuildResources& resources;
  const MemoryPlan memory;  ///< Made once, with the kind of source that it is for.
  BuildReport report;
  /// While nothing is done that a resumed build would not do again: an error then leaves no folder.
  bool begins_anew = false;

  [[nodiscard]] FileLayer& files() const;
  /// What a plan is made for.
  [[nodiscard]] PlanRequest plan_request(const SourceDisk& disk) const;
  void tell(const BuildPlan& plan) const;
  void tell(const StageProgress& progress) const;
  /// A stage of the observer's progress.
  [[nodiscard]] std::function<void(std::uint64_t done, std::uint64_t total)> stage(
      const char* name) const;
  /// All stages of it, by name.
  [[nodiscard]] std::function<void(const char* name, std::uint64_t done, std::uint64_t total)>
  stages() const;
  [[nodiscard]] SourceOptions source_options() const;
};

/// What a build works on, of whatever kind its source is.
struct TiledSource {
  TerrainFrame frame;
  MeasureUnits units;
  TileTree tree;
  std::function<LeafStarter()> make_starter;  ///< Called once for each thread.
};

/// What is being handled, as an Error: what libraries throw, and the caller's own functions.
/// To be called while an exception is handled.
[[nodiscard]] Error error_in_flight();

/// The same error, and that the work in `folder` can be gone on with.
[[nodiscard]] Error with_resume_hint(const Error& error, const std::string& folder);

/// What decides the bytes of the output, that its inputs are still the ones it began with, and the
/// program, whose temporary files another version may not understand. To be taken before anything
/// is read: a file that is replaced meanwhile is another one then.
[[nodiscard]] nlohmann::json fingerprint(const Job& job);

/// Opens the job's workspace, works in it, and removes it, or keeps it where there is work to go on
/// with: the error says so then. @throws Error as Workspace, and what `work` throws
void in_workspace(Job& job, const nlohmann::json& fingerprint,
                  const std::function<void(Workspace&)>& work);

/// What the tiles are built with.
[[nodiscard]] HierarchyOptions hierarchy_options(const Job& job, const TiledSource& source,
                                                 const BuildPlan& plan);

/// Collapses, tightens and publishes; or sees that an interrupted build had done all of that.
void build_tiles(Workspace& workspace, Job& job, const TiledSource& source, const BuildPlan& plan);

/// Says what is expected before anything but headers and first lines is read, and refuses what
/// cannot do. With points that may be left out it is no reason to refuse.
/// @param disk_of  What the source takes.
/// @throws Error as count_points() and plan_build()
void plan_before_reading(const Job& job,
                         const std::function<SourceDisk(const PointCount&)>& disk_of);

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
