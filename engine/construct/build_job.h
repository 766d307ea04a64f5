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
#include "engine/construct/hierarchy/tile_bytes.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/points/point_count.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/workspace.h"
#include "engine/construct/tasks/task_driver.h"
#include "engine/construct/tile/tile_tree.h"
#include "engine/construct/tile_tasks/build_hierarchy.h"
#include "engine/construct/tiled_source.h"

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
  SourceLines lines{};  ///< The lines beside the points; set once read.
  /// The inode of the finished pages, from when they are about to get the output's name.
  std::optional<std::uint64_t> inode_of_output{};
  nlohmann::json began_with{};  ///< input_fingerprint() before anything was read.
  bool inputs_changed = false;  ///< Since then: what was read of them may be of both.
  /// True when the source is read and others do the rest (TaskDriver::begin): the folder stays.
  bool goes_on_elsewhere = false;

  /// The layer that files are written through: the caller's, or the system's.
  [[nodiscard]] FileLayer& files() const;
  /// The request for the plan of this job.
  /// @param disk  What its source takes of the disk.
  [[nodiscard]] PlanRequest plan_request(const SourceDisk& disk) const;
  /// Hands a plan, or progress, to the observer; does nothing where there is none.
  void tell(const BuildPlan& plan) const;
  void tell(const StageProgress& progress) const;
  [[nodiscard]] SourceOptions source_options() const;
  /// Has tasks of reading done, by the driver or by threads of this process.
  [[nodiscard]] RunTasks run_tasks() const;
  /// Announces the build to the driver (TaskDriver::begin).
  /// @param index      index_json() of the source; null before it is read.
  /// @param workspace  Null before there is one.
  [[nodiscard]] bool begin(const nlohmann::json& index, const Workspace* workspace) const;
  /// Where the build's temporary files go: BuildResources::tmp, but for files that other processes
  /// read, too, which lie beside the output.
  [[nodiscard]] std::string exchange_folder() const {
    return resources.driver ? "" : resources.tmp;
  }
  /// Where this process alone keeps what it sorts.
  [[nodiscard]] std::string sorting_folder(const Workspace& workspace) const;
};

/// The exception that is being handled, as an Error: of this library, of others, or of a function of
/// the caller's. REQUIRES: an exception is being handled.
[[nodiscard]] Error error_in_flight();

/// The same error, whose message also says that the work in `folder` is kept, and by which option
/// a build goes on with it.
[[nodiscard]] Error with_resume_hint(const Error& error, const std::string& folder);

/// The inputs, and the files of lines that the options name.
[[nodiscard]] std::vector<std::string> all_inputs(const std::vector<std::string>& inputs,
                                                  const BuildOptions& options);

/// What a resumed build must agree with: the options that decide the bytes of the output; names,
/// sizes and times of the inputs; and the version of the program, since another one may not
/// understand its temporary files. To be taken before anything is read, so that an input that is
/// replaced meanwhile is seen to be another one.
[[nodiscard]] nlohmann::json fingerprint(const Job& job);

/// Opens the job's workspace, calls `work` in it, and removes it. After an error the workspace is
/// kept where a resumed build could go on with it, and the error then says so (with_resume_hint()).
/// @throws Error as Workspace, and what `work` throws
void in_workspace(Job& job, const nlohmann::json& fingerprint,
                  const std::function<void(Workspace&)>& work);

/// What the tiles are built with.
[[nodiscard]] HierarchyOptions hierarchy_options(const Job& job, const TiledSource& source,
                                                 const BuildPlan& plan);

/// Collapses all tiles, tightens them and publishes the file, unless an input changed meanwhile.
/// @param index  index_json() of the source, for other processes of the build (take_up_source()).
/// @throws Error as build_hierarchy() and StoreOutput
void build_tiles(Workspace& workspace, Job& job, const TiledSource& source, const BuildPlan& plan,
                 const nlohmann::json& index);

/// Plans a build over points or a TIN from the headers and first lines of its inputs, reports it to
/// the observer, and refuses a build that the memory or the disk cannot hold. A source of which any
/// part may be left out (by class, bounds or nodata) is never refused here, nor is a pipe, which is
/// not looked into.
/// @param disk_of  What the source takes of the disk, given how many points it has.
/// @throws Error as count_points() and plan_build()
void plan_before_reading(const Job& job,
                         const std::function<SourceDisk(const PointCount&)>& disk_of);

/// The facts of a source's index under the name of its kind.
[[nodiscard]] nlohmann::json index_json(const char* kind, const ArrayFileFacts& index);
/// The index of a source that an interrupted build had sorted on disk.
struct KeptIndex {
  std::optional<ArrayFileFacts> facts;  ///< None where the build had not got so far.
  bool is_sound = false;                ///< Nobody has noted that the source is damaged.
};
/// The note under `key`.
[[nodiscard]] KeptIndex kept_index(const Workspace& workspace, const std::string& key);
/// Notes that the sorted source is damaged: kept_index() of a resumed build has none.
/// @throws Error io_error, resource_exhausted
void forget_index(Workspace& workspace);
/// Takes up the sorted source that an interrupted build had noted under `key`.
/// @param load  Given the facts of its index.
/// @return  What `load` gives; none where nothing was noted, or a file of the source is damaged or
///     gone, which is then noted.
/// @throws Error  what else `load` throws; as forget_index()
template <class Load>
[[nodiscard]] auto taken_up(Workspace& workspace, const char* key, const Load& load)
    -> std::optional<decltype(load(ArrayFileFacts{}))> {
  const KeptIndex kept = kept_index(workspace, key);
  if (!kept.is_sound) {
    return std::nullopt;
  }
  try {
    return load(*kept.facts);
  } catch (const Error& e) {
    if (!is_lost_sorted_source(e, workspace.temporary_folder())) {
      throw;
    }
  }
  forget_index(workspace);
  return std::nullopt;
}
/// Notes the index of a sorted source in the manifest, so that a resumed build does not read and
/// sort the source again.
/// @throws Error corruption  it is another one than an interrupted build had noted; io_error
void note_index(const Job& job, Workspace& workspace, const char* kind,
                const ArrayFileFacts& index);
/// Plans the tiles of a source that has been sorted, and reports it to the observer.
/// @throws Error as plan_build()
[[nodiscard]] BuildPlan plan_sorted(const Job& job, const TileTree& tree, SourceDisk disk);

/// Builds over points, which are sorted on disk first (points/point_buckets.h).
void build_points(Job& job);
/// Builds over somebody's TIN, which is sorted on disk first (tin/tin_source.h).
void build_tin(Job& job);

}  // namespace ptin::build_internal
