// SPDX-License-Identifier: GPL-3.0-or-later
//
// Does the tasks of a build one after the other, counts them, and lets a test do something to the
// files between them.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "engine/construct/tasks/task_driver.h"

namespace ptin::test {

enum class Damage { kFlipped, kCut, kRemoved };

/// Damages a file: its last byte is another one, the second half of it is gone, or all of it.
inline void damage(const std::string& path, Damage how) {
  namespace fs = std::filesystem;
  if (how == Damage::kRemoved) {
    fs::remove(path);
  } else if (how == Damage::kCut) {
    fs::resize_file(path, fs::file_size(path) / 2);
  } else {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(-1, std::ios::end);
    const auto byte = static_cast<char>(file.get() ^ 1);
    file.seekp(-1, std::ios::end);
    file.put(byte);
  }
}

class DamagingDriver final : public TaskDriver {
 public:
  using Before = std::function<void(const Task& task, const std::string& folder)>;
  /// @param before  Called before each task, with the folder of temporary files.
  explicit DamagingDriver(Before before) : before_(std::move(before)) {}

  [[nodiscard]] bool begin(const BuildNote& note) override {
    folder_ = note.temporary;
    return true;
  }
  std::uint64_t run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& /*limits*/,
                    const std::stop_token& /*stop*/) override {
    while (schedule.next_bytes()) {
      const Task task = schedule.take();
      before_(task, folder_);
      try {
        const TaskResult result = worker.run(task);
        ++done[task.name];
        schedule.done(task.name, result);
      } catch (const DamagedInput& damage) {
        schedule.failed(task.name, damage);
      }
    }
    return 0;
  }

  std::map<TaskName, int> done;  ///< How often each task was done.

 private:
  Before before_;
  std::string folder_;
};

}  // namespace ptin::test
