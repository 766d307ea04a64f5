// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which tasks may be done next.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "engine/construct/tasks/stage_progress.h"
#include "engine/construct/tasks/task.h"

namespace ptin {

/// Hands out tasks, whoever does them. A task that was handed out is either done or failed.
/// Threads: one at a time, but for progress().
class TaskSchedule {
 public:
  TaskSchedule() = default;
  TaskSchedule(const TaskSchedule&) = delete;
  TaskSchedule& operator=(const TaskSchedule&) = delete;
  virtual ~TaskSchedule() = default;

  /// Memory that the next task takes, in bytes. None when there is no task to hand out, or when
  /// those left must wait for one that is being done.
  [[nodiscard]] virtual std::optional<std::uint64_t> next_bytes() const = 0;
  /// Hands that task out. REQUIRES: next_bytes() has a value.
  [[nodiscard]] virtual Task take() = 0;
  /// To be called when a task was done.
  virtual void done(const TaskName& name, const TaskResult& result) = 0;
  /// To be called when a task met a damaged input. By default this throws it.
  virtual void failed(const TaskName& name, const DamagedInput& damage);
  /// Notes how much of a task is done, as Task::progress. Threads: any number.
  virtual void progress(const TaskName& name, std::uint64_t done) = 0;
  /// Takes up what was done elsewhere, before anything is handed out. By default there is nothing.
  virtual void take_up(const TaskResults& results);
};

/// Tasks that are all named from the beginning. Hands out the first whose inputs are known.
class TaskList final : public TaskSchedule {
 public:
  /// Gives a task by its name and the results so far; none while it must wait for some of them.
  using Describe = std::function<std::optional<Task>(const TaskName&, const TaskResults&)>;
  /// @param known  Results of tasks that are not of the list.
  TaskList(const std::vector<TaskName>& tasks, Describe describe, TaskResults known);
  /// Tasks of reading a source, which do not depend on one another.
  /// @param sizes  Size of each, in a unit of the stage's own: for progress.
  /// @param bytes  Memory that each takes at least, by estimate.
  /// @param plan   The facts of the file that they go by; none where there is no such file.
  TaskList(TaskKind kind, std::vector<std::uint64_t> sizes, std::uint64_t bytes,
           const std::optional<ArrayFileFacts>& plan = {});

  [[nodiscard]] std::optional<std::uint64_t> next_bytes() const override;
  [[nodiscard]] Task take() override;
  void done(const TaskName& name, const TaskResult& result) override;
  void progress(const TaskName& name, std::uint64_t done) override;

  /// Tasks of reading: their price, and who hears how far they are, from one thread at a time.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  void set_bytes(std::uint64_t bytes) noexcept { bytes_ = bytes; }
  void tell(std::function<void(const StageProgress& progress)> tell) { tell_ = std::move(tell); }

  /// Those that are known and those that were done since.
  [[nodiscard]] const TaskResults& results() const noexcept { return results_; }
  [[nodiscard]] bool is_complete() const noexcept { return left_.empty(); }
  [[nodiscard]] std::size_t left() const noexcept { return left_.size(); }

 private:
  [[nodiscard]] std::optional<Task> task_of(const TaskName& name) const;
  [[nodiscard]] std::list<TaskName>::const_iterator next() const;

  std::list<TaskName> left_;
  Describe describe_;
  TaskResults results_;
  std::vector<InputFile> inputs_;
  std::uint64_t bytes_ = 0;
  std::function<void(const StageProgress& progress)> tell_;
  std::vector<std::uint64_t> sizes_;  ///< Sizes of tasks of reading.
  std::mutex mutex_;                  ///< Guards what follows.
  std::vector<std::uint64_t> done_;   ///< How much of each is done.
  std::uint64_t all_done_ = 0, total_ = 0;
};

}  // namespace ptin
