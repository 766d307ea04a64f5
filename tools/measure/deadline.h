// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stop token that fires when time is up.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

namespace ptin::tools {

/// Seconds on the clock.
[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Begins when it is made. Threads: const functions may be called at once.
class Deadline {
 public:
  /// @param seconds  Until the token fires; the caller's own stop fires it, too.
  Deadline(double seconds, std::stop_token caller);
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  [[nodiscard]] std::stop_token token() const noexcept { return source_.get_token(); }
  /// It has fired because time was up, and not because the caller stops.
  [[nodiscard]] bool is_over() const noexcept {
    return source_.stop_requested() && !caller_.stop_requested();
  }
  /// Seconds since it was made.
  [[nodiscard]] double elapsed() const { return seconds_since(begin_); }

 private:
  void wait(const std::stop_token& done, double seconds);
  struct Fire {
    std::stop_source source;
    void operator()() { source.request_stop(); }
  };

  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::stop_token caller_;
  std::stop_source source_;
  std::stop_callback<Fire> of_caller_;
  std::mutex lock_;
  std::condition_variable_any change_;
  std::jthread timer_;  ///< Last, so that it ends first.
};

}  // namespace ptin::tools
