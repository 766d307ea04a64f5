// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/temporary_path.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

namespace ptin::tools {

namespace {

/// The living ones; a place is free where it holds null.
std::array<std::atomic<const TemporaryPath*>, 32> living_paths{};

void remove_folder_with_files(const char* path) noexcept {
  DIR* const folder = opendir(path);
  if (folder == nullptr) return;
  while (const dirent* entry = readdir(folder)) {
    if (std::strcmp(entry->d_name, ".") != 0 && std::strcmp(entry->d_name, "..") != 0)
      unlinkat(dirfd(folder), entry->d_name, 0);
  }
  closedir(folder);
  rmdir(path);
}

}  // namespace

TemporaryPath::TemporaryPath(std::string path, std::span<const char* const> beside) noexcept
    : path_(std::move(path)), beside_(beside) {
  for (auto& place : living_paths) {
    const TemporaryPath* nobody = nullptr;
    if (place.compare_exchange_strong(nobody, this)) return;
  }
}

TemporaryPath::~TemporaryPath() {
  remove();
  for (auto& place : living_paths) {
    const TemporaryPath* expected = this;
    if (place.compare_exchange_strong(expected, nullptr)) return;
  }
}

void TemporaryPath::remove() const noexcept {
  if (!is_kept_ && unlink(path_.c_str()) != 0 && (errno == EISDIR || errno == EPERM))
    remove_folder_with_files(path_.c_str());
  for (const char* ending : beside_) {
    std::array<char, PATH_MAX> name{};
    const int length = std::snprintf(name.data(), name.size(), "%s%s", path_.c_str(), ending);
    if (length > 0 && static_cast<std::size_t>(length) < name.size()) unlink(name.data());
  }
}

void remove_temporary_paths() noexcept {
  for (const auto& place : living_paths) {
    if (const TemporaryPath* path = place.load()) path->remove();
  }
}

}  // namespace ptin::tools
