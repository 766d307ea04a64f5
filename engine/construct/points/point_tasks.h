// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading and sorting a source of points as tasks, each from files to files.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/points/point_files.h"
#include "engine/construct/points/point_reading.h"
#include "engine/construct/points/sort_plan.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tasks/task_schedule.h"

namespace ptin {

/// Does the tasks of reading points (points/point_reading.h), of sharing them out
/// (points/point_shares.h) and of sorting them (points/range_buckets.h). Whoever gives the inputs and
/// options of the build, and sees its folder, can do each of them.
class PointTasks final : public TaskWorker {
 public:
  PointTasks(std::vector<std::string> inputs, SourceOptions options, PointFiles files);

  /// @return  The facts of what came of it, TileFile::kIndex; none of a portion that has quotes.
  /// @throws Error  as PortionReader::read(), share_out() and sort_range()
  [[nodiscard]] TaskResult run(const Task& task) override;

  /// Those of reading, whose plan is written to a file.
  [[nodiscard]] TaskList reading(const ReadingPlan& plan) const;
  /// Those of sharing out by a plan, which is kept for the tasks of this process.
  [[nodiscard]] TaskList sharing(std::shared_ptr<const SortPlan> plan);
  /// Those of sorting what was shared out.
  /// @param shares  What came of sharing out.
  [[nodiscard]] TaskList sorting(const std::vector<ArrayFileFacts>& shares);

  [[nodiscard]] const PointFiles& files() const noexcept { return files_; }

 private:
  [[nodiscard]] ArrayFileFacts index_of(const Task& task);
  [[nodiscard]] ArrayFileFacts read(const Task& task);
  [[nodiscard]] std::shared_ptr<const SortPlan> plan_of(const ArrayFileFacts& facts);

  std::vector<std::string> inputs_;
  SourceOptions options_;
  PointFiles files_;
  PortionReader reader_;
  std::mutex mutex_;  ///< Guards the plan.
  ArrayFileFacts plan_facts_;
  std::shared_ptr<const SortPlan> plan_;
};

}  // namespace ptin
