// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/task_schedule.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/check.h"

namespace ptin {

void TaskSchedule::failed(const TaskName& /*name*/, const DamagedInput& damage) {
  throw DamagedInput(damage);
}

void TaskSchedule::take_up(const TaskResults& /*results*/) {}

TaskList::TaskList(const std::vector<TaskName>& tasks, Describe describe, TaskResults known)
    : left_(tasks.begin(), tasks.end()),
      describe_(std::move(describe)),
      results_(std::move(known)) {}

TaskList::TaskList(TaskKind kind, std::vector<std::uint64_t> sizes, std::uint64_t bytes,
                   const std::optional<ArrayFileFacts>& plan)
    : bytes_(bytes),
      sizes_(std::move(sizes)),
      done_(sizes_.size()),
      total_(std::accumulate(sizes_.begin(), sizes_.end(), std::uint64_t{0})) {
  for (std::size_t number = 0; number < sizes_.size(); ++number) {
    left_.push_back(numbered(kind, number));
  }
  if (plan) {
    inputs_.push_back({{}, TileFile::kIndex, *plan});
  }
}

std::optional<Task> TaskList::task_of(const TaskName& name) const {
  return describe_ ? describe_(name, results_) : Task{name, inputs_, 0, bytes_};
}

/// Mostly the first: whoever lists tasks names those that wait for others behind these.
std::list<TaskName>::const_iterator TaskList::next() const {
  return std::find_if(left_.begin(), left_.end(),
                      [this](const TaskName& name) { return task_of(name).has_value(); });
}

std::optional<std::uint64_t> TaskList::next_bytes() const {
  const auto at = next();
  return at == left_.end() ? std::nullopt : std::optional(task_of(*at)->bytes);
}

Task TaskList::take() {
  const auto at = next();
  PTIN_CHECK(at != left_.end());
  Task task = *task_of(*at);
  left_.erase(at);
  return task;
}

void TaskList::done(const TaskName& name, const TaskResult& result) {
  results_[name] = result;
  progress(name, ~std::uint64_t{0});
}

void TaskList::progress(const TaskName& name, std::uint64_t done) {
  if (!tell_) {
    return;
  }
  const std::lock_guard lock(mutex_);
  std::uint64_t& before = done_.at(number_of(name));
  done = std::min(done, sizes_[number_of(name)]);  // what a task reports may go by an estimate
  if (done > before) {
    all_done_ += done - before;
    before = done;
    tell_({stage_of(name.kind), all_done_, total_, 0, 0});
  }
}

}  // namespace ptin
