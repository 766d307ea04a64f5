// SPDX-License-Identifier: GPL-3.0-or-later
//
// A build over somebody else's triangles: counted first, sorted on disk, then tiles.
#include <algorithm>
#include <utility>

#include "engine/construct/build_job.h"
#include "engine/construct/memory_plan.h"
#include "engine/construct/points/point_count.h"
#include "engine/construct/tin/tin_source.h"
#include "engine/construct/tin/tin_tile.h"
#include "engine/error.h"

namespace ptin::build_internal {

namespace {

/// The triangles as an interrupted build had sorted them, or else read and sorted now.
/// @param index_facts  Receives those of their index.
TinTriangles sorted_triangles(Job& job, Workspace& workspace, ArrayFileFacts& index_facts) {
  const std::string kept_as = workspace.temporary(kTinTriangles);
  const std::string index = workspace.temporary(kTinIndex);
  const auto load = [&](const ArrayFileFacts& facts) {
    index_facts = facts;
    return TinTriangles::load(job.files(), kept_as, index, facts);
  };
  if (auto triangles = taken_up(workspace, "tin", load)) {
    return std::move(*triangles);
  }
  for (const std::string& name : TinTriangles::kept_files(kTinTriangles)) {
    workspace.remove(name);
  }
  const auto progress = [&job](const char* stage, std::uint64_t done, std::uint64_t total) {
    job.tell(StageProgress{stage, done, total});
  };
  TinTriangles triangles =
      TinTriangles::read(job.inputs[0], job.source_options(),
                         {job.files(), job.sorting_folder(workspace), job.memory.sorting},
                         job.resources.stop, progress, kept_as);
  index_facts = triangles.save(job.files(), index);
  note_index(job, workspace, "tin", index_facts);
  return triangles;
}

void report_counts(BuildReport& report, const TinTriangles& triangles) {
  const TinCounts& counts = triangles.counts();
  report.warnings.join(triangles.warnings());
  report.source_samples = report.vertices = counts.vertices;
  report.left_out.add(LeftOutReason::kNoTriangle, counts.unused_vertices);
  report.left_out_triangles = counts.left_out_triangles;
  report.void_triangles = counts.void_triangles;
  report.merged_points = counts.merged_vertices;
  report.largest_shift_plan = counts.largest_shift_plan;
  report.height_rounding = triangles.frame().height_rounding;
}

void build_tin_in(Workspace& workspace, Job& job) {
  ArrayFileFacts index;
  const TinTriangles triangles = sorted_triangles(job, workspace, index);
  report_counts(job.report, triangles);
  const TiledSource tiles = tiled(triangles, job.options);
  const BuildPlan plan =
      plan_sorted(job, tiles.tree, TinTriangles::disk_of(triangles.counts().vertices));
  build_tiles(workspace, job, tiles, plan, index_json("tin", index));
}

}  // namespace

void build_tin(Job& job) {
  plan_before_reading(job,
                      [](const PointCount& count) { return TinTriangles::disk_of(count.points); });
  if (job.resources.dry_run) {
    return;
  }
  in_workspace(job, fingerprint(job), [&](Workspace& workspace) { build_tin_in(workspace, job); });
}

}  // namespace ptin::build_internal
