// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/piece_runner.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "engine/error.h"
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

class Runner {
 public:
  Runner(PieceSource& source, const PieceLimits& limits, const std::stop_token& stop)
      : source_(source), limits_(limits), on_stop_(stop, [this] { halt_.request_stop(); }) {}

  /// Locks the mutex of the workers and lets go of it. Called before they begin, this orders all
  /// that the calling thread did before all that they do; called after they have ended, it orders
  /// all that they did before what this thread does next. oneTBB orders both as well, but thread
  /// sanitizers do not see that.
  void meet() { const std::lock_guard lock(mutex_); }
  /// One worker: takes pieces until there are none.
  void work(int worker) noexcept;
  void rethrow() const {
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    stop_if_asked(halt_.get_token(), "the build");
  }
  [[nodiscard]] std::uint64_t most_bytes() const { return most_bytes_; }

 private:
  std::optional<Piece> take(std::unique_lock<std::mutex>& lock, int worker);
  void run(const Piece& piece, std::unique_lock<std::mutex>& lock);
  void give_back(std::unique_lock<std::mutex>& lock, std::uint64_t bytes) const;
  void fail(std::exception_ptr failure);

  PieceSource& source_;
  PieceLimits limits_;
  std::stop_source halt_;
  std::stop_callback<std::function<void()>> on_stop_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int running_ = 0;
  std::uint64_t bytes_ = 0, most_bytes_ = 0;
  std::exception_ptr failure_;
};

/// Waits for a piece that fits, and takes it. None once a stop is asked for, or when the source has
/// no piece and none runs whose commit could bring one.
std::optional<Piece> Runner::take(std::unique_lock<std::mutex>& lock, int worker) {
  bool gave_back = false;
  while (!halt_.stop_requested()) {
    const std::optional<std::uint64_t> bytes = source_.next_bytes();
    if (bytes && (running_ == 0 || bytes_ + *bytes <= limits_.bytes)) {
      Piece piece = source_.take(worker);
      ++running_;
      bytes_ += piece.bytes;
      most_bytes_ = std::max(most_bytes_, bytes_);
      return piece;
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

void Runner::give_back(std::unique_lock<std::mutex>& lock, std::uint64_t bytes) const {
  if (limits_.give_back) {
    const Unlocked others_may_go_on(lock);
    limits_.give_back(bytes);
  }
}

void Runner::run(const Piece& piece, std::unique_lock<std::mutex>& lock) {
  std::function<void()> commit;
  {
    const Unlocked others_may_go_on(lock);
    commit = piece.run(halt_.get_token());
  }
  if (!halt_.stop_requested()) {
    commit();
  }
}

void Runner::fail(std::exception_ptr failure) {
  if (!failure_ && !halt_.stop_requested()) {
    failure_ = std::move(failure);
  }
  halt_.request_stop();
}

void Runner::work(int worker) noexcept {
  std::unique_lock lock(mutex_);
  std::uint64_t last_bytes = ~std::uint64_t{0};
  try {
    while (const std::optional<Piece> piece = take(lock, worker)) {
      try {
        if (piece->bytes > last_bytes) {
          give_back(lock, bytes_);
        }
        last_bytes = piece->bytes;
        run(*piece, lock);
      } catch (...) {
        fail(std::current_exception());
      }
      --running_;
      bytes_ -= piece->bytes;
      changed_.notify_all();
    }
  } catch (...) {  // thrown by the source or give_back
    fail(std::current_exception());
    changed_.notify_all();
  }
}

}  // namespace

std::uint64_t run_pieces(PieceSource& source, const PieceLimits& limits,
                         const std::stop_token& stop) {
  Runner runner(source, limits, stop);
  if (limits.threads <= 1) {
    runner.work(0);
  } else {
    const auto threads = static_cast<std::size_t>(limits.threads);
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(limits.threads);
    runner.meet();
    arena.execute([&] {
      tbb::task_group group;
      for (int i = 0; i < limits.threads; ++i) {
        group.run([&runner, i] { runner.work(i); });
      }
      group.wait();
    });
  }
  runner.meet();
  runner.rethrow();
  return runner.most_bytes();
}

}  // namespace ptin
