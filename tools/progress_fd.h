// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progress for programs that run this one: a line of JSON now and then on a file descriptor.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace ptin::tools {

/// Writes `{"stage", "done", "total", "seconds", "memory"}` at most five times a second, and at the
/// beginning and the end of each stage. A reader that went away is no fault.
class ProgressFd {
 public:
  /// @throws Error invalid_argument  the descriptor is not open for writing
  explicit ProgressFd(int fd);

  /// @param memory  Bytes of anonymous memory.
  void report(const char* stage, std::uint64_t done, std::uint64_t total, std::uint64_t memory);

 private:
  int fd_;
  std::string stage_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace ptin::tools
