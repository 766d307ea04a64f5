// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a source to a published .ptin file.
#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/build_observer.h"
#include "engine/construct/build_options.h"
#include "engine/construct/build_plan.h"
#include "engine/construct/grid/left_out.h"
#include "engine/construct/grid/point_classes.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/scratch/workspace.h"

namespace ptin {

class TaskDriver;

/// How the work is done; never changes a byte of the file.
struct BuildResources {
  bool overwrite = false;
  /// Limit on the anonymous memory of the process, bytes, kept by measured estimates
  /// (engine/DESIGN.md, section 5.10); 0 means default_memory().
  std::uint64_t memory_bytes = 0;
  int threads = 0;  ///< 0 means allowed_threads(). Fewer are used where memory is short.
  std::string tmp;  ///< Folder for temporary files; "" means beside the output.
  Unfinished unfinished = Unfinished::kRefuse;          ///< What to do with an interrupted build.
  bool dry_run = false;                                 ///< Stop when the plan is made.
  std::chrono::milliseconds checkpoint_interval{2000};  ///< Least time between checkpoints.
  /// How long a worker of another machine waits for a file that was named to it and that it does
  /// not see yet: what network file systems remember of a folder may be old (BuildWorker,
  /// do_part()).
  std::chrono::milliseconds patience{0};
  TaskDriver* driver = nullptr;  ///< Who has the tasks done; borrowed; null: threads.
  FileLayer* files = nullptr;    ///< Through which to write; null means the system. For tests.
  std::stop_token stop;
  BuildObserver* observer = nullptr;  ///< Hears of the work; null: nobody does. Borrowed.
};

/// A build that is resumed though its output was complete has no counts of points and TINs but
/// those that the file states.
struct BuildReport {
  std::uint64_t source_samples = 0;  ///< With a height; of points and TINs, distinct positions.
  std::uint64_t void_samples = 0;    ///< Rasters: without a height.
  std::uint64_t lone_samples = 0;    ///< Samples that touch no surface triangle, treated as void.
  LeftOutPoints left_out;            ///< Points; of a TIN, vertices.
  PointClasses classes;              ///< Points of LAS, also of classes that are left out.
  std::vector<std::string> empty_inputs;  ///< Points: files without any, not even one left out.
  SourceWarnings warnings;                ///< Those of the inputs, and of the lines.
  std::uint64_t left_out_triangles = 0;   ///< TINs: hidden, or with a corner of no height.
  std::uint64_t void_triangles = 0;       ///< TINs: of the full TIN, between surface and hull.
  std::uint64_t merged_points = 0;        ///< Points less the positions that they fell on.
  double largest_shift_plan = 0.0;        ///< Distance that snapping moved one, CRS units.
  double largest_shift_height = 0.0;      ///< Distance that merging moved one, height's unit.
  double height_quantum = 0.0;            ///< Points: the smallest step between heights.
  double height_rounding = 0.0;           ///< Bound of what storing moved one by, height's unit.
  std::uint64_t vertices = 0;             ///< Vertices of the full TIN.
  std::uint64_t records = 0;              ///< Written.
  std::uint64_t t0_vertices = 0;
  std::uint16_t max_rank = 0;  ///< Chains of splits are at most one longer.
  std::uint64_t file_bytes = 0;
  std::uint64_t source_bytes = 0;  ///< Bytes of all files of all inputs; 0 where unknown.
  double seconds = 0.0;
  bool resumed = false;  ///< An interrupted build was taken up.
  /// Why temporary files could not be removed after the output was complete; "" when they were.
  std::string left_behind;
};

/// Builds `output` from `inputs` (one raster or several of one grid; or points; or a TIN). The
/// output's name does not appear before the file is complete.
/// @throws Error invalid_argument, not_found: nothing is left behind. (An output that is one of the inputs is
///               refused, by whatever name, also where it may be overwritten.)
///               io_error, resource_exhausted, cancelled: a build over tiles that has begun is kept
///               beside the output (workspace.h) and can be resumed; the message names the folder.
///               internal: something else than an Error was thrown, by a function of the caller's,
///               too; kept likewise. (std::bad_alloc comes as resource_exhausted.)
/// Memory: within BuildResources::memory_bytes. Points and triangles are sorted into temporary
/// files first; a resumed build takes up points that were sorted to the end.
BuildReport build(const std::vector<std::string>& inputs, const std::string& output,
                  const BuildOptions& options, const BuildResources& resources);

}  // namespace ptin
