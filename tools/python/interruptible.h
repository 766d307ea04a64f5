// SPDX-License-Identifier: GPL-3.0-or-later
//
// Work of the engine while Python goes on: without the GIL, and ended by Ctrl-C.
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

/// Waits, without the GIL, until `is_done`. Every 50 ms it looks for signals; when a handler of one
/// raises an exception, as Ctrl-C does, it asks for a stop, once, and waits on.
/// REQUIRES: the GIL; whoever makes `is_done` true holds the mutex of `lock` and notifies.
/// @return True where a handler raised; the exception is set.
[[nodiscard]] bool wait_for_signals_too(std::unique_lock<std::mutex>& lock,
                                        std::condition_variable& changed, std::stop_source& stop,
                                        const std::function<bool()>& is_done);

/// Throws the exception that is set.  REQUIRES: the GIL; one is set.
[[noreturn]] void raise_what_is_set();

/// Runs `work` without the GIL on a thread of its own, and meanwhile looks for signals.
/// REQUIRES: the GIL; `work` obeys `stop`, and lets go of no object of Python's.
/// @throws what `work` throws; the exception of a signal's handler
template <typename Work>
auto run_interruptibly(std::stop_source& stop, const Work& work) {
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
  const bool is_interrupted = wait_for_signals_too(lock, changed, stop, [&] { return done; });
  lock.unlock();
  worker.join();
  if (is_interrupted) raise_what_is_set();
  if (failure) std::rethrow_exception(failure);
  return std::move(*result);
}

}  // namespace ptin::python
