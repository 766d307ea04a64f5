// SPDX-License-Identifier: GPL-3.0-or-later
//
// A source of points of any number: read once, and sorted into buckets.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/points/point_buckets.h"
#include "engine/construct/points/point_files.h"
#include "engine/construct/points/point_portions.h"
#include "engine/construct/points/point_reading.h"
#include "engine/construct/points/point_tasks.h"
#include "engine/construct/points/sort_plan.h"
#include "engine/construct/tasks/task_driver.h"

namespace ptin {

/// What reading and sorting goes by, beside the source.
struct PointWork {
  PointFiles files;
  RunTasks run;  ///< Has the tasks done.
  std::stop_token stop{};
  std::uint64_t memory = std::uint64_t{64} << 20;  ///< For what this process does by itself, bytes.
  /// Called with how far is what this process does by itself; may be empty.
  std::function<void(const StageProgress& progress)> progress{};
  PortionSizes portions{};
  SortSizes sorting{};
};

/// Reads files of points once, in portions, then puts what they hold on one grid and sorts it, in
/// ranges of the Hilbert curve: a sample sort. Each step is a stage of tasks (points/point_tasks.h) that
/// any process does; what is found out between them is found out here.
///
/// The result depends on the set of points alone, not on their order, on the files that they come
/// from, or on who did which task when; but for PointMerge::kFirst, which goes by the first two.
///
/// Disk, in files.folder, named: 27 bytes a point from when it is read, and 16 (for kFirst 24) more when
/// it is shared out; then the former go, and buckets come, at most 16, mostly half of that
/// (points/packed_bucket.h). Memory of a task: some MiB, and to sort a range as Task::bytes
/// says; here 32 bytes for each of at most 2^20 buckets, and 48 for each of at most 2^18 samples.
class PointSource {
 public:
  /// Reads the points of all files. A pipe is read on this thread.
  /// @param options  Its lines are borrowed until the last sort().
  /// @throws Error  not_found, io_error, unsupported_version  as open_point_stream()
  ///                invalid_argument    as the streams; CRSs or units that differ; no points
  ///                resource_exhausted  the disk is full
  ///                cancelled           `work.stop` fired
  ///                corruption          as sort()
  ///                If several files cannot be read, the error is the first one's. All are opened
  ///                before any is read.
  PointSource(const std::vector<std::string>& inputs, const SourceOptions& options, PointWork work);
  /// Removes all files but buckets, whatever comes of that.
  ~PointSource();
  PointSource(const PointSource&) = delete;
  PointSource& operator=(const PointSource&) = delete;

  /// Sorts the points, with options.lines as they are now.
  ///
  /// Grid: the unit is `options.resolution`, and the origin a multiple of it. Without a resolution
  /// the unit is the power of ten of the CRS unit that keeps every digit of every x and y, and the
  /// origin is the smallest x and y. LAS declares its digits with its scale factor. Where a scale
  /// factor is no power of ten, the smallest of such files is the unit, and the origin is aligned
  /// with the offset of its file.
  /// Merging: points that fall together become one. `options.merge` decides its height: by default
  /// the mean, rounded to a code where heights are codes.
  /// Lines: the vertices of `options.lines`, noded (lines/line_noding.h), are points too. A point
  /// that falls on one of them is merged into it, whatever the rule: the line's height stands. Points
  /// outside of the boundary are left out.
  /// Heights: int32 with the power of ten that keeps every digit, where that fits; else as for a
  /// Float64 raster (grid/height_fit.h).
  /// CRS: `options.a_srs`, else the CRS that all files declare.
  /// @param buckets  The path of the files of buckets, to which "-" and a number is added. They stay.
  /// @param is_last  No other call comes: what was read can go.
  /// @throws Error  invalid_argument    fewer than 3 distinct points; all collinear; an extent of more
  ///                                    than 2^30 grid units (the message names a resolution); lines
  ///                                    that do not go together with the points
  ///                corruption          a temporary file is not what was written, after all points were
  ///                                    read once more for such a file, or from a pipe
  ///                io_error, resource_exhausted, cancelled  as the constructor
  [[nodiscard]] PointBuckets sort(const std::string& buckets, bool is_last);

 private:
  void remove_files() noexcept;
  template <class Work>
  auto undamaged(const Work& work);
  void read();
  [[nodiscard]] bool is_read_once() const;
  [[nodiscard]] PointBuckets sort_once(const std::string& buckets, bool is_last);
  [[nodiscard]] std::vector<ArrayFileFacts> run(TaskList tasks, bool alone);
  [[nodiscard]] std::vector<SpooledPortion> read_all();
  [[nodiscard]] std::vector<std::optional<SpooledPortion>> read_some(const ReadingPlan& plan);
  [[nodiscard]] PointBuckets::Index begin_index(const PointGrid& grid) const;
  void join_ranges(const std::vector<ArrayFileFacts>& found, const SortPlan& plan,
                   PointBuckets::Index& index) const;

  std::vector<std::string> inputs_;
  SourceOptions options_;
  PointWork work_;
  PointTasks tasks_;
  std::optional<PointReading> reading_;
  bool was_damaged_ = false;  ///< A temporary file was, and all points were read once more.
};

}  // namespace ptin
