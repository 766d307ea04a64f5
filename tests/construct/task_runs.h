// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lists of tasks, done as a test wants it.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <utility>
#include <vector>

#include "engine/construct/tasks/task_driver.h"

namespace ptin::test {

/// Does the tasks on so many threads, each within so many bytes.
inline RunTasks on_threads(int threads, std::uint64_t bytes = 0, const std::stop_token& stop = {},
                           const std::function<void(const StageProgress&)>& tell = {}) {
  return [=](TaskList& tasks, TaskWorker& worker) {
    tasks.set_bytes(bytes);
    tasks.tell(tell);
    TaskDriver().run(tasks, worker, {threads}, stop);
  };
}

/// All tasks of a list, which then has none left.
inline std::vector<Task> taken_from(TaskList& tasks) {
  std::vector<Task> all;
  while (tasks.next_bytes()) {
    all.push_back(tasks.take());
  }
  return all;
}

}  // namespace ptin::test
