// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of a log to a descriptor that may stop taking them: nobody waits for it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

namespace ptin::serve {

/// Writes on a thread of its own. Threads: add() from any.
class LogWriter {
 public:
  /// @param fd          Open for writing while this object lives. A pipe that nobody reads any more
  ///                    needs SIGPIPE to be ignored.
  /// @param most_lines  Wait at once; further ones are dropped, and their number is told by a line
  ///                    {"event":"dropped","lines":N} once there is room.
  explicit LogWriter(int fd, std::size_t most_lines = 4096);
  /// Writes what waits, for at most a second.
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// @param line  Without its end.
  void add(const std::string& line);

 private:
  void work();
  /// False where the descriptor took it no more.
  [[nodiscard]] bool write_whole(const std::string& text);
  [[nodiscard]] bool waits_for_room();

  int fd_;
  std::size_t most_lines_;
  std::mutex mutex_;
  std::condition_variable has_line_, ends_soon_;
  std::deque<std::string> lines_;
  std::uint64_t dropped_ = 0;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace ptin::serve
