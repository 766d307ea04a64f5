// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/stage_runner.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <numeric>
#include <system_error>
#include <thread>
#include <utility>

#include "engine/stop.h"

namespace ptin {

namespace {

/// The tasks of a stage as threads take them.
class TasksOfStage {
 public:
  TasksOfStage(const SourceStage& stage, StageWorker& worker, const StageLimits& limits,
               std::size_t threads)
      : stage_(stage),
        worker_(worker),
        limits_(limits),
        memory_of_task_(limits.memory / threads),
        count_(stage, limits),
        stops_(stage.sizes.size()),
        results_(stage.sizes.size()),
        on_stop_(limits.stop, [this] { stop_from(0); }) {}

  /// What one thread does.
  void work() {
    for (std::size_t number = take(); number < stage_.sizes.size(); number = take()) {
      try {
        results_[number] = worker_.run(
            {stage_.name, number, stage_.facts, memory_of_task_, stops_[number].get_token(),
             [this, number](std::uint64_t done) { count_.tell(number, done); }});
        count_.tell_all_of(number);
      } catch (...) {
        fail(number, std::current_exception());
      }
    }
  }

  [[nodiscard]] std::vector<std::string> results() {
    if (error_) {
      std::rethrow_exception(error_);
    }
    stop_if_asked(limits_.stop, stage_.name.c_str());
    return std::move(results_);
  }

 private:
  /// The next task; behind the last, or behind one that failed, there is none.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    const bool is_wanted = next_ < failed_ && !limits_.stop.stop_requested();
    return is_wanted ? next_++ : stage_.sizes.size();
  }

  void fail(std::size_t number, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (number < failed_) {
      failed_ = number;
      error_ = std::move(error);
      stop_from(number + 1);
    }
  }

  void stop_from(std::size_t number) {
    for (; number < stops_.size(); ++number) {
      stops_[number].request_stop();
    }
  }

  const SourceStage& stage_;
  StageWorker& worker_;
  const StageLimits& limits_;
  const std::uint64_t memory_of_task_;
  StageCount count_;
  std::vector<std::stop_source> stops_;
  std::vector<std::string> results_;
  std::mutex mutex_;  ///< Guards what follows.
  std::size_t next_ = 0;
  std::size_t failed_ = std::numeric_limits<std::size_t>::max();  ///< The lowest that failed.
  std::exception_ptr error_;                                      ///< Its error.
  std::stop_callback<std::function<void()>> on_stop_;
};

}  // namespace

StageCount::StageCount(const SourceStage& stage, const StageLimits& limits)
    : stage_(stage),
      limits_(limits),
      done_(stage.sizes.size()),
      total_(std::accumulate(stage.sizes.begin(), stage.sizes.end(), std::uint64_t{0})) {}

void StageCount::tell(std::size_t number, std::uint64_t done) {
  const std::lock_guard lock(mutex_);
  done = std::min(done, stage_.sizes[number]);
  if (done <= done_[number]) {
    return;
  }
  all_done_ += done - done_[number];
  done_[number] = done;
  if (limits_.progress) {
    limits_.progress(all_done_, total_);
  }
}

std::vector<std::string> run_stage(const SourceStage& stage, StageWorker& worker,
                                   const StageLimits& limits) {
  const std::size_t threads =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::max(limits.threads, 1)), 1,
                              std::max<std::size_t>(stage.sizes.size(), 1));
  TasksOfStage tasks(stage, worker, limits, threads);
  {
    std::vector<std::jthread> others;
    try {
      for (std::size_t i = 1; i < threads; ++i) {
        others.emplace_back([&] { tasks.work(); });
      }
    } catch (const std::system_error&) {  // No more threads are given: those that are there do all.
    }
    tasks.work();
  }
  return tasks.results();
}

}  // namespace ptin
