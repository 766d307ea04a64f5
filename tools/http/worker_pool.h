// SPDX-License-Identifier: GPL-3.0-or-later
//
// Threads that compute answers, behind a queue that has an end.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace ptin::http {

/// Runs tasks on a fixed number of threads, first come, first served. A task must not throw.
/// Threads: add() and waiting() may be called from any.
class WorkerPool {
 public:
  /// @param threads  At least one.
  /// @param waiting  Most tasks that wait while all threads work.
  WorkerPool(std::size_t threads, std::size_t waiting);
  /// Runs what waits, then ends the threads.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// @return False where the queue is full: the task is not taken.
  [[nodiscard]] bool add(std::function<void()> task);
  /// Tasks that no thread has taken up.
  [[nodiscard]] std::size_t waiting() const;
  /// Tasks that run now.
  [[nodiscard]] std::size_t running() const;

 private:
  void work();

  std::size_t most_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable has_task_;
  std::deque<std::function<void()>> tasks_;
  std::size_t running_ = 0;
  bool ends_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace ptin::http
