// SPDX-License-Identifier: GPL-3.0-or-later
//
// Who has the tasks of a build done, of reading its source and of its tiles: threads of this
// process, or other processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "engine/construct/tasks/task_messages.h"
#include "engine/construct/tasks/task_schedule.h"

namespace ptin {

/// What the tasks of one process may take.
struct TaskLimits {
  int threads = 1;
  std::uint64_t bytes = ~std::uint64_t{0};  ///< The sum over all tasks that run at once.
  /// Called with the bytes that the tasks at work take; to give freed memory back to the system
  /// where so much would not fit beside what the process holds. What a heap keeps of tasks that
  /// have ended is counted for no task. Called by a thread that must wait (`bytes` includes the
  /// task that it waits to start), and by one whose next task is larger than its last. May be
  /// empty.
  std::function<void(std::uint64_t bytes)> give_back{};
};

/// Runs tasks until the schedule has none left: here on threads of this process, as many at once as
/// memory admits. A task starts whatever its price when no other runs, and else only within the
/// limit.
class TaskDriver {
 public:
  TaskDriver() = default;
  TaskDriver(const TaskDriver&) = delete;
  TaskDriver& operator=(const TaskDriver&) = delete;
  virtual ~TaskDriver() = default;

  /// Called with the build before the first task of reading, then without the index that reading
  /// makes, and before the first task of its tiles. By default it does nothing.
  /// @return  False: the build ends here, and its folder stays for those who do the tasks.
  [[nodiscard]] virtual bool begin(const BuildNote& note);
  /// How many processes do the tasks of reading at once.
  [[nodiscard]] virtual std::size_t processes_that_read() const noexcept { return 1; }
  /// After an error nothing more begins. Tasks that were begun later than the one that met it are
  /// stopped, and those that were begun before it go on to their end, since their errors come first; what
  /// they make is told to the schedule.
  /// @param worker  Does tasks in this process.
  /// @param limits  Limits of this process.
  /// @return The most bytes that were admitted at once in this process, by estimate.
  /// @throws Error cancelled  `stop` fired; and whatever a task, the schedule or give_back throws,
  ///     but for DamagedInput, which the schedule hears of: of several errors that of the task
  ///     that was handed out first
  virtual std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
                            const std::stop_token& stop);
};

/// Has all tasks of a list done, by whomever.
/// @throws Error  as TaskDriver::run()
using RunTasks = std::function<void(TaskList& tasks, TaskWorker& worker)>;
/// One task after the other, on this thread.
void run_alone(TaskList& tasks, TaskWorker& worker);

}  // namespace ptin
