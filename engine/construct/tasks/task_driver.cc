// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/task_driver.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "engine/stop.h"

namespace ptin {

namespace {

/// Lets go of a lock while this object lives, and takes it again however the scope ends.
class Unlocked {
 public:
  explicit Unlocked(std::unique_lock<std::mutex>& lock) : lock_(lock) { lock_.unlock(); }
  ~Unlocked() { lock_.lock(); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  std::unique_lock<std::mutex>& lock_;
};

/// Threads that take tasks of one schedule.
class ThreadRun {
 public:
  ThreadRun(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
            const std::stop_token& stop)
      : schedule_(schedule),
        worker_(worker),
        limits_(limits),
        stop_(stop),
        at_work_(static_cast<std::size_t>(std::max(limits.threads, 1))),
        on_stop_(stop, [this] { stop_after(0); }) {}

  /// Runs all tasks on this thread and others.
  void run();
  void rethrow() const {
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    stop_if_asked(stop_, "the build");
  }
  [[nodiscard]] std::uint64_t most_bytes() const noexcept { return most_bytes_; }

 private:
  /// What one thread does. Its token is asked for a stop once, since nothing begins after that.
  struct AtWork {
    std::stop_source stop;
    std::uint64_t number = 0;  ///< Its task's place in the order of handing out, from 1.
  };

  void work(AtWork& mine) noexcept;
  [[nodiscard]] bool is_over() const { return failure_ || stop_.stop_requested(); }
  std::optional<Task> take(std::unique_lock<std::mutex>& lock, AtWork& mine);
  void run_one(const Task& task, std::unique_lock<std::mutex>& lock);
  void give_back(std::unique_lock<std::mutex>& lock, std::uint64_t bytes) const;
  void fail(std::uint64_t number);
  void stop_after(std::uint64_t number);

  TaskSchedule& schedule_;
  TaskWorker& worker_;
  const TaskLimits& limits_;
  const std::stop_token stop_;
  std::vector<AtWork> at_work_;  ///< By thread.
  std::mutex mutex_;             ///< Guards what follows, the numbers and the schedule.
  std::condition_variable changed_;
  int running_ = 0;
  std::uint64_t taken_ = 0, bytes_ = 0, most_bytes_ = 0;
  bool schedule_threw_ = false;
  std::exception_ptr failure_;
  std::uint64_t failed_ = 0;  ///< The number of the task whose error that is.
  std::stop_callback<std::function<void()>> on_stop_;
};

/// Waits for a task that fits, and takes it. None once a stop is asked for, or when there is no task
/// and none runs that could bring one.
std::optional<Task> ThreadRun::take(std::unique_lock<std::mutex>& lock, AtWork& mine) {
  bool gave_back = false;
  while (!is_over()) {
    const std::optional<std::uint64_t> bytes = schedule_.next_bytes();
    if (bytes && (running_ == 0 || bytes_ + *bytes <= limits_.bytes)) {
      Task task = schedule_.take();
      ++running_;
      mine.number = ++taken_;
      bytes_ += task.bytes;
      most_bytes_ = std::max(most_bytes_, bytes_);
      return task;
    }
    if (running_ == 0) {
      return std::nullopt;
    }
    if (!gave_back) {
      give_back(lock, bytes_ + bytes.value_or(0));
      gave_back = true;
      continue;  // something may have ended meanwhile
    }
    changed_.wait(lock);
  }
  return std::nullopt;
}

void ThreadRun::give_back(std::unique_lock<std::mutex>& lock, std::uint64_t bytes) const {
  if (limits_.give_back) {
    const Unlocked others_may_go_on(lock);
    limits_.give_back(bytes);
  }
}

/// Runs a task, and reports to the schedule what came of it: after the error of another task too, for a
/// build that goes on; but neither after a stop nor to a schedule that threw, which may be half changed.
void ThreadRun::run_one(const Task& task, std::unique_lock<std::mutex>& lock) {
  std::optional<DamagedInput> damage;
  TaskResult result;
  {
    const Unlocked others_may_go_on(lock);
    try {
      result = worker_.run(task);
    } catch (const DamagedInput& e) {
      damage.emplace(e);
    }
  }
  if (stop_.stop_requested() || schedule_threw_) {
    return;
  }
  schedule_threw_ = true;
  if (damage) {
    schedule_.failed(task.name, *damage);
  } else {
    schedule_.done(task.name, result);
  }
  schedule_threw_ = false;
}

/// Keeps the exception that is being handled, unless one of an earlier task is known, or it may come
/// of a stop that was asked for.
void ThreadRun::fail(std::uint64_t number) {
  if (!stop_.stop_requested() && (!failure_ || number < failed_)) {
    failure_ = std::current_exception();
    failed_ = number;
    stop_after(number);
  }
}

/// Asks tasks for a stop that were handed out after this one. Called without the lock when all are
/// to stop, since who asks for that may hold it: then no number is looked at.
void ThreadRun::stop_after(std::uint64_t number) {
  for (AtWork& one : at_work_) {
    if (number == 0 || one.number > number) {
      one.stop.request_stop();
    }
  }
}

void ThreadRun::work(AtWork& mine) noexcept {
  std::unique_lock lock(mutex_);
  std::uint64_t last_bytes = ~std::uint64_t{0};
  try {
    while (std::optional<Task> task = take(lock, mine)) {
      try {
        if (task->bytes > last_bytes) {
          give_back(lock, bytes_);
        }
        last_bytes = task->bytes;
        task->stop = mine.stop.get_token();
        task->progress = [this, name = task->name](std::uint64_t done) {
          schedule_.progress(name, done);
        };
        run_one(*task, lock);
      } catch (...) {
        fail(mine.number);
      }
      --running_;
      bytes_ -= task->bytes;
      changed_.notify_all();
    }
  } catch (...) {  // thrown by the schedule or give_back, behind all that was handed out
    schedule_threw_ = true;
    fail(taken_ + 1);
    changed_.notify_all();
  }
}

void ThreadRun::run() {
  std::vector<std::jthread> others;
  try {
    for (std::size_t i = 1; i < at_work_.size(); ++i) {
      others.emplace_back([this, i] { work(at_work_[i]); });
    }
  } catch (const std::system_error&) {  // No more threads are given: those that are there do all.
  }
  work(at_work_[0]);
}

}  // namespace

bool TaskDriver::begin(const BuildNote& /*note*/) { return true; }

std::uint64_t TaskDriver::run(TaskSchedule& schedule, TaskWorker& worker, const TaskLimits& limits,
                              const std::stop_token& stop) {
  ThreadRun threads(schedule, worker, limits, stop);
  threads.run();
  threads.rethrow();
  return threads.most_bytes();
}

void run_alone(TaskList& tasks, TaskWorker& worker) { TaskDriver().run(tasks, worker, {}, {}); }

}  // namespace ptin
