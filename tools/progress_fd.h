// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress for programs that run this one: a line of JSON now and then on a file descriptor.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace ptin::tools {

/// What is known of a stage besides `done` and `total`.
struct ProgressFacts {
  std::uint64_t memory = 0;  ///< Bytes of anonymous memory.
  std::uint64_t tiles_done = 0, tiles = 0;
  std::uint64_t per_second = 0;     ///< Units of `done`.
  double remaining_seconds = -1.0;  ///< Seconds left of this stage; < 0 when unknown.
};

/// Writes `{"stage", "done", "total", "seconds", "memory", "tiles_done", "tiles", "per_second",
/// "remaining_seconds"}` at most five times a second, and at the beginning and the end of each
/// stage. When the reader has gone away, nothing more is written; that is no error.
class ProgressFd {
 public:
  /// @throws Error invalid_argument  the descriptor is not open for writing
  explicit ProgressFd(int fd);

  void report(const char* stage, std::uint64_t done, std::uint64_t total,
              const ProgressFacts& facts);

 private:
  int fd_;
  std::string stage_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace ptin::tools
