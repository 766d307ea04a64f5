// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/file_questions.h"

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin {

namespace {

namespace fs = std::filesystem;

void require(const std::error_code& failure, const char* action, const std::string& path) {
  if (failure) {
    throw system_error(failure.value(), action, path);
  }
}

}  // namespace

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

bool is_there(const std::string& path) {
  std::error_code failure;
  const bool result = fs::exists(path, failure);
  require(failure, "cannot look whether there is a file", path);
  return result;
}

void require_readable(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return;
  }
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    throw system_error(errno, "cannot open", path);
  }
  char first = 0;
  const bool is_refused = ::read(fd, &first, 1) < 0;
  const int failure = errno;
  ::close(fd);
  if (is_refused) {
    throw system_error(failure, "cannot read", path);
  }
}

std::uint64_t bytes_of_file(const std::string& path) {
  std::error_code failure;
  const std::uint64_t bytes = fs::file_size(path, failure);
  require(failure, "cannot look at the size of the file", path);
  return bytes;
}

std::vector<std::string> paths_in(const std::string& folder) {
  std::error_code failure;
  std::vector<std::string> paths;
  fs::directory_iterator entry(folder, failure);
  for (; !failure && entry != fs::directory_iterator(); entry.increment(failure)) {
    paths.push_back(entry->path().string());
  }
  require(failure, "cannot list the folder", folder);
  return paths;
}

std::string absolute_path(const std::string& path) {
  std::error_code failure;
  const fs::path whole = fs::absolute(path, failure);
  require(failure, "cannot find the working folder", path);
  return whole.string();
}

std::string system_temporary_folder() {
  std::error_code failure;
  const fs::path folder = fs::temp_directory_path(failure);
  require(failure, "cannot use the system's folder for temporary files (TMPDIR)", folder.string());
  return folder.string();
}

}  // namespace ptin
