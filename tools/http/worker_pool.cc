// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/http/worker_pool.h"

#include <utility>

namespace ptin::http {

WorkerPool::WorkerPool(std::size_t threads, std::size_t waiting) : most_waiting_(waiting) {
  threads_.reserve(threads);
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  has_task_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool WorkerPool::add(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    // A task that finds an idle thread does not wait: as many as there are idle threads may stand
    // in the queue beside those that wait.
    const std::size_t idle = threads_.size() - running_;
    if (tasks_.size() >= most_waiting_ + idle) return false;
    tasks_.push_back(std::move(task));
  }
  has_task_.notify_one();
  return true;
}

std::size_t WorkerPool::waiting() const {
  const std::lock_guard lock(mutex_);
  return tasks_.size();
}

std::size_t WorkerPool::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

void WorkerPool::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_task_.wait(lock, [this] { return ends_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    ++running_;
    lock.unlock();
    task();
    lock.lock();
    --running_;
  }
}

}  // namespace ptin::http
