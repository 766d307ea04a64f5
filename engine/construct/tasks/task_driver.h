// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who has the tasks of a build done, of reading its source and of its tiles: threads of this
// process, or other processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "engine/construct/grid/source_stage.h"
#include "engine/construct/tasks/piece_runner.h"
#include "engine/construct/tasks/stage_runner.h"
#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tile_tasks/tile_schedule.h"
#include "engine/construct/tile_tasks/tile_worker.h"

namespace ptin {

/// Runs tasks until the schedule has none left.
class TaskDriver {
 public:
  TaskDriver() = default;
  TaskDriver(const TaskDriver&) = delete;
  TaskDriver& operator=(const TaskDriver&) = delete;
  virtual ~TaskDriver() = default;

  /// Told of the build before the first stage of reading, without what reading finds out. By default
  /// it does nothing.
  virtual void begin_reading(const BuildNote& note);
  /// How many processes do the tasks of reading at once.
  [[nodiscard]] virtual std::size_t processes_that_read() const noexcept { return 1; }
  /// Has a stage of reading done: by default on threads of this process.
  /// @param worker  Does its tasks in this process.
  /// @throws Error  as RunStage
  [[nodiscard]] virtual std::vector<std::string> run_stage(const SourceStage& stage,
                                                           StageWorker& worker,
                                                           const StageLimits& limits);
  /// Told of the build before the first task of its tiles. By default it does nothing.
  /// @return  False: the build ends here, and its folder stays for those who do the tasks.
  [[nodiscard]] virtual bool begin(const BuildNote& note);
  /// @param worker  Does tasks in this process.
  /// @param limits  Of this process.
  /// @return The most bytes that were admitted at once in this process, by estimate.
  /// @throws Error cancelled  `stop` fired; and whatever a task or the schedule throws, but for
  ///     DamagedInput, of which the schedule is told
  virtual std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const PieceLimits& limits,
                            const std::stop_token& stop) = 0;
};

/// Threads of this process, as many at once as memory admits (piece_runner.h).
class ThreadDriver final : public TaskDriver {
 public:
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const PieceLimits& limits,
                    const std::stop_token& stop) override;
};

}  // namespace ptin
