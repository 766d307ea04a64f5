// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/await_file.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <thread>

#include "engine/stop.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

/// Has the system look what is in a folder, whatever comes of it.
void read_folder(const std::string& folder) {
  std::error_code ignored;
  for (std::filesystem::directory_iterator at(folder, ignored), end; !ignored && at != end;
       at.increment(ignored)) {
  }
}

}  // namespace

bool await_file(const std::string& path, std::chrono::milliseconds patience,
                const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLongestPause{1000};
  const auto until = std::chrono::steady_clock::now() + patience;
  for (std::chrono::milliseconds pause{10}; !is_there(path);
       pause = std::min(pause * 2, kLongestPause)) {
    const auto now = std::chrono::steady_clock::now();
    if (now >= until) {
      return false;
    }
    stop_if_asked(stop, "the build");
    std::this_thread::sleep_for(std::min<std::chrono::steady_clock::duration>(pause, until - now));
    read_folder(folder_of(path));
  }
  return true;
}

}  // namespace ptin
