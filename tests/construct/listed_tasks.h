// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tasks of given prices, and a worker that does what a test says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/construct/tasks/task_driver.h"

namespace ptin::test {

/// Tasks of these prices, one after the other.
class ListedTasks final : public TaskSchedule {
 public:
  explicit ListedTasks(std::vector<std::uint64_t> prices) : prices_(std::move(prices)) {}
  [[nodiscard]] std::optional<std::uint64_t> next_bytes() const override {
    return next_ == prices_.size() ? std::nullopt : std::optional(prices_[next_]);
  }
  [[nodiscard]] Task take() override {
    const std::uint64_t bytes = prices_[next_];
    return {numbered(TaskKind::kRead, next_++), {}, 0, bytes};
  }
  void done(const TaskName& name, const TaskResult& /*result*/) override {
    ended.push_back(prices_[number_of(name)]);
    if (when_done) {
      when_done(number_of(name));
    }
  }
  void progress(const TaskName& /*name*/, std::uint64_t /*done*/) override {}

  std::vector<std::uint64_t> ended;  ///< The prices of those that are done.
  std::function<void(std::size_t number)> when_done;

 private:
  std::vector<std::uint64_t> prices_;
  std::size_t next_ = 0;
};

/// Does what a test says, for each task; tells what that returns.
class ToldWorker final : public TaskWorker {
 public:
  explicit ToldWorker(std::function<std::string(const Task&)> what) : what_(std::move(what)) {}
  [[nodiscard]] TaskResult run(const Task& task) override {
    TaskResult result;
    result.told = what_(task);
    return result;
  }

 private:
  std::function<std::string(const Task&)> what_;
};

}  // namespace ptin::test
