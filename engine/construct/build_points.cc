// SPDX-License-Identifier: GPL-3.0-or-later
//
// A build over points: counted first, sorted into buckets, then tiles.
#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

#include "engine/construct/build_job.h"
#include "engine/construct/delaunay/line_drape.h"
#include "engine/construct/delaunay/point_tile.h"
#include "engine/construct/lines/source_lines.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/construct/points/point_count.h"
#include "engine/construct/points/point_source.h"
#include "engine/construct/tin/tin_vertices.h"
#include "engine/error.h"

namespace ptin::build_internal {

namespace {

/// The files of the points' buckets while lines are laid on them.
constexpr const char* kPointsBelow = "below";

PointFiles point_files(const Job& job, const Workspace& workspace) {
  return {job.files(), workspace.temporary_folder()};
}

PointWork work_of(const Job& job, const Workspace& workspace) {
  return {point_files(job, workspace), job.run_tasks(), job.resources.stop, job.memory.sorting,
          [&job](const StageProgress& progress) { job.tell(progress); }};
}

/// Vertices of TINs are sorted before they are points.
SourceDisk disk_of(const Job& job, const PointCount& count) {
  SourceDisk disk = PointBuckets::disk_of(count.points, job.source_options().merge);
  const TaskDriver* const driver = job.resources.driver;
  const std::uint64_t of_tins =
      count.of_tins_at_once(driver == nullptr ? 1 : driver->processes_that_read());
  disk.while_reading = std::max(
      disk.while_reading,
      disk.spooled + of_tins * TinVertices::disk_of_vertex(job.options.nodata.has_value()));
  if (job.lines.want_ground()) {
    disk.while_reading += disk.kept;  // the points below the lines, until they lie on them
  }
  return disk;
}

/// Adds the lines of `more`, which have ground as those of `set`.
void append(const LineSet& more, LineSet& set) {
  const std::size_t before = set.vertices.size();
  set.vertices.insert(set.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const std::uint64_t end : more.ends) {
    set.ends.push_back(before + end);
  }
}

/// Lays lines and a boundary without heights on the points. They are sorted for this, and once more
/// with the lines.
void lay_lines(Job& job, const PointFiles& files, PointSource& source) {
  const PointBuckets points = source.sort(files.path(kPointsBelow, 0), false);
  SourceLines& lines = job.lines;
  LineDrape drape(lines.rings_are_flat ? lines.rings : LineSet{}, lines.flat_breaklines, points);
  const auto progress = [&job](std::uint64_t done, std::uint64_t total) {
    job.tell(StageProgress{"laying the lines", done, total});
  };
  LineDrape::Laid laid = drape.lay(job.options.max_edge, job.memory.lines / kBytesOfLineVertex,
                                   job.resources.stop, progress);
  lines.breaklines = drape.divided_lines(false);
  append(laid.lines, lines.breaklines);
  lines.rings = lines.rings_are_flat ? std::move(laid.rings) : drape.divided_lines(true);
  lines.flat_breaklines = {};
  lines.rings_are_flat = false;
  lines.are_laid = true;
}

/// The points as an interrupted build had sorted them, or else read and sorted now.
/// @param index_facts  Receives those of their index.
PointBuckets sorted_points(Job& job, Workspace& workspace, ArrayFileFacts& index_facts) {
  const std::string buckets = workspace.temporary(kPointBuckets);
  const std::string index = workspace.temporary(kPointsIndex);
  const auto load = [&](const ArrayFileFacts& facts) {
    index_facts = facts;
    return PointBuckets::load(job.files(), buckets, index, facts);
  };
  if (auto points = taken_up(workspace, "points", load)) {
    job.lines = {};
    return std::move(*points);
  }
  remove_files(job.files(), buckets + "-");
  std::ignore = job.begin({}, &workspace);
  PointBuckets points = [&] {
    PointSource source(job.inputs, job.source_options(), work_of(job, workspace));
    if (job.lines.want_ground()) {
      const PointFiles files = point_files(job, workspace);
      lay_lines(job, files, source);
      files.remove_all(kPointsBelow);
    }
    return source.sort(buckets, true);
  }();
  job.lines = {};  // the points have what they need of them
  index_facts = points.save(job.files(), index);
  note_index(job, workspace, "points", index_facts);
  return points;
}

void report_counts(const Job& job, const PointBuckets& points, BuildReport& report) {
  for (const std::uint64_t input : points.empty_inputs()) {
    report.empty_inputs.push_back(job.inputs[input]);
  }
  report.warnings.join(points.warnings());
  report.source_samples = report.vertices = points.size();
  report.left_out = points.counts().left_out;
  report.classes = points.counts().classes;
  report.merged_points = points.counts().merged_points;
  report.largest_shift_plan = points.counts().largest_shift_plan;
  report.largest_shift_height = points.counts().largest_shift_height;
  report.height_quantum = points.frame().height_quantum;
  report.height_rounding = points.frame().height_rounding;
}

void build_points_in(Workspace& workspace, Job& job) {
  ArrayFileFacts index;
  const PointBuckets points = sorted_points(job, workspace, index);
  report_counts(job, points, job.report);
  const TiledSource tiles = tiled(points, job.options, job.resources.stop);
  const BuildPlan plan = plan_sorted(job, tiles.tree, PointBuckets::disk_of(points.size()));
  build_tiles(workspace, job, tiles, plan, index_json("points", index));
}

}  // namespace

void build_points(Job& job) {
  const GdalCacheLimit cache(job.memory.gdal_cache);
  const nlohmann::json began_with = fingerprint(job);  // before the first look into the inputs
  job.lines = read_source_lines(line_choice_of(job.options), job.memory.lines, job.resources.stop);
  job.report.warnings.join(job.lines.warnings);
  plan_before_reading(job, [&](const PointCount& count) { return disk_of(job, count); });
  if (job.resources.dry_run) {
    return;
  }
  in_workspace(job, began_with, [&](Workspace& workspace) { build_points_in(workspace, job); });
}

}  // namespace ptin::build_internal
