// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/log_writer.h"

#include <algorithm>
#include <cerrno>
#include <chrono>

#include <poll.h>
#include <unistd.h>

namespace ptin::serve {

namespace {

/// A pipe that is ready takes so much at once without blocking (PIPE_BUF of Linux).
constexpr std::size_t kAtOnce = 4096;
constexpr std::chrono::milliseconds kGather{5};
constexpr int kLookMilliseconds = 100;
constexpr int kLooksAtTheEnd = 10;

}  // namespace

LogWriter::LogWriter(int fd, std::size_t most_lines)
    : fd_(fd), most_lines_(most_lines), thread_([this] { work(); }) {}

LogWriter::~LogWriter() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  has_line_.notify_one();
  ends_soon_.notify_one();
  thread_.join();
}

void LogWriter::add(const std::string& line) {
  bool was_empty = false;
  {
    const std::lock_guard lock(mutex_);
    was_empty = lines_.empty();
    if (lines_.size() >= most_lines_) {
      ++dropped_;
      return;
    }
    if (dropped_ > 0 && lines_.size() < most_lines_ / 2) {
      lines_.push_back(R"({"event":"dropped","lines":)" + std::to_string(dropped_) + "}\n");
      dropped_ = 0;
    }
    lines_.push_back(line + "\n");
  }
  if (was_empty) has_line_.notify_one();
}

void LogWriter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_line_.wait(lock, [this] { return ends_ || !lines_.empty(); });
    // Lines that come close behind each other are written at once.
    ends_soon_.wait_for(lock, kGather, [this] { return ends_; });
    if (lines_.empty()) return;
    std::string text;
    for (const std::string& line : lines_) text += line;
    lines_.clear();
    lock.unlock();
    const bool is_taken = write_whole(text);
    lock.lock();
    if (!is_taken && ends_) return;
  }
}

bool LogWriter::write_whole(const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    if (!waits_for_room()) return false;
    const ssize_t n = ::write(fd_, text.data() + written, std::min(text.size() - written, kAtOnce));
    if (n < 0 && errno != EINTR && errno != EAGAIN) return false;  // This line is lost.
    written += n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  return true;
}

/// True once the descriptor takes something; false where the writer ends before.
bool LogWriter::waits_for_room() {
  int looks_left = kLooksAtTheEnd;
  while (true) {
    pollfd look{fd_, POLLOUT, 0};
    if (::poll(&look, 1, kLookMilliseconds) > 0) return true;
    const std::lock_guard lock(mutex_);
    if (ends_ && --looks_left <= 0) return false;
  }
}

}  // namespace ptin::serve
