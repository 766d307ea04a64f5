// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/progress_fd.h"

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/error.h"

namespace ptin::tools {

ProgressFd::ProgressFd(int fd) : fd_(fd) {
  const int flags = ::fcntl(fd, F_GETFL);
  if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) {
    throw Error(ErrorCode::invalid_argument,
                "--progress-fd " + std::to_string(fd) + ": no descriptor that is open for writing");
  }
}

void ProgressFd::report(const char* stage, std::uint64_t done, std::uint64_t total,
                        const ProgressFacts& facts) {
  const auto now = std::chrono::steady_clock::now();
  if (fd_ < 0 ||
      (stage_ == stage && done < total && now - last_ < std::chrono::milliseconds(200))) {
    return;
  }
  stage_ = stage;
  last_ = now;
  nlohmann::json json{{"stage", stage},
                      {"done", done},
                      {"total", total},
                      {"seconds", std::chrono::duration<double>(now - begin_).count()},
                      {"memory", facts.memory},
                      {"tiles_done", facts.tiles_done},
                      {"tiles", facts.tiles},
                      {"per_second", facts.per_second},
                      {"remaining_seconds", nullptr}};
  if (facts.remaining_seconds >= 0) json["remaining_seconds"] = facts.remaining_seconds;
  const std::string line = json.dump() + "\n";
  if (::write(fd_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    fd_ = -1;  // The reader has gone away.
  }
}

}  // namespace ptin::tools
