// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work of the engine while Python goes on: without the GIL, and ended by Ctrl-C or the end of Python.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <type_traits>
#include <utility>

namespace ptin::python {

/// A question while it is answered without the GIL. When Python ends, all are stopped and waited for:
/// CPython before 3.14 ends a thread that wants the GIL later within its destructors, and so the
/// process. Made and destroyed with the GIL, which guards what is known of all.
class Question {
 public:
  /// @param stop  What ends it; none of one that is over at once.
  /// @throws SystemExit  Python is ending: a thread beside the main one asks nothing more
  explicit Question(std::stop_source stop = std::stop_source(std::nostopstate));
  ~Question();
  Question(const Question&) = delete;
  Question& operator=(const Question&) = delete;

  /// Waits, without the GIL, until `is_done`. The main thread, to which Python gives signals, looks
  /// for them every 50 ms; when a handler of one raises an exception, as Ctrl-C does, it asks for a
  /// stop, once, and waits on.
  /// REQUIRES: the GIL; whoever makes `is_done` true holds the mutex of `lock` and notifies.
  /// @return True where a handler raised; the exception is set.
  [[nodiscard]] bool wait(std::unique_lock<std::mutex>& lock, std::condition_variable& changed,
                          const std::function<bool()>& is_done);
  [[nodiscard]] const std::stop_source& stop() const noexcept { return stop_; }

 private:
  std::stop_source stop_;
};

/// True where Python is ending and this is not the thread that ends it.  REQUIRES: the GIL.
[[nodiscard]] bool is_ended_by_python() noexcept;

/// Raises SystemExit, by which a thread ends silently, where is_ended_by_python().
void exit_if_ended_by_python();

/// Throws the exception that is set.  REQUIRES: the GIL; one is set.
[[noreturn]] void raise_what_is_set();

/// Runs `work` without the GIL on a thread of its own, and meanwhile looks for signals.
/// REQUIRES: the GIL; `work` obeys `stop`, and lets go of no object of Python's.
/// @throws what `work` throws; the exception of a signal's handler; SystemExit as Question does
template <typename Work>
auto run_interruptibly(std::stop_source& stop, const Work& work) {
  Question question(stop);
  using Result = std::invoke_result_t<Work>;
  std::optional<Result> result;
  std::exception_ptr failure;
  bool done = false;
  std::mutex mutex;
  std::condition_variable changed;
  std::jthread worker([&] {
    try {
      result.emplace(work());
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    done = true;
    changed.notify_all();
  });
  std::unique_lock lock(mutex);
  const bool is_interrupted = question.wait(lock, changed, [&] { return done; });
  lock.unlock();
  worker.join();
  if (is_interrupted) raise_what_is_set();
  if (failure) {
    exit_if_ended_by_python();
    std::rethrow_exception(failure);
  }
  return std::move(*result);
}

}  // namespace ptin::python
