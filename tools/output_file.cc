// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output_file.h"

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"

namespace ptin::tools {

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

namespace {

static_assert(std::endian::native == std::endian::little,
              "write_value() states little-endian files");

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

Error exists_already(const std::string& path) {
  return {ErrorCode::invalid_argument,
          "exists already; give another name, or --overwrite to replace it", path};
}

/// Renames in one step, and syncs the folder.
void rename_into_place(const std::string& from, const std::string& to, bool overwrite) {
  const unsigned flags = overwrite ? 0U : static_cast<unsigned>(RENAME_NOREPLACE);
  int renamed = renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags);
  if (renamed != 0 && errno == EEXIST) throw exists_already(to);
  if (renamed != 0 && errno == EINVAL)
    renamed = rename(from.c_str(), to.c_str());  // file system without it
  if (renamed != 0) throw system_error(errno, "cannot rename the finished output", to);
  const int folder = open(folder_of(to).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    fsync(folder);
    close(folder);
  }
}

}  // namespace

void check_output(const std::string& path, bool overwrite) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode))
      throw Error(ErrorCode::invalid_argument, "is a folder; give a file name", path);
    if (!S_ISREG(status.st_mode)) {
      throw Error(ErrorCode::invalid_argument,
                  "is a device or a pipe, which a finished file cannot replace; give a file name",
                  path);
    }
    if (!overwrite) throw exists_already(path);
  } else if (stat(folder_of(path).c_str(), &status) != 0) {
    throw Error(ErrorCode::not_found, "the folder of the output does not exist; make it first",
                folder_of(path));
  }
}

OutputFile::OutputFile(std::string path, bool overwrite)
    : path_(std::move(path)), overwrite_(overwrite) {
  check_output(path_, overwrite_);
  temporary_ = path_ + ".tmp" + std::to_string(getpid());
  fd_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) throw system_error(errno, "cannot create the output", path_);
  buffer_.reserve(kBufferBytes);
}

OutputFile::~OutputFile() {
  if (fd_ >= 0) close(fd_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void OutputFile::write(const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  if (buffer_.size() + bytes > kBufferBytes) flush();
  if (bytes >= kBufferBytes) {
    buffer_.assign(at, at + bytes);
    flush();
  } else {
    buffer_.insert(buffer_.end(), at, at + bytes);
  }
}

void OutputFile::flush() {
  std::size_t at = 0;
  while (at < buffer_.size()) {
    const ssize_t n = ::write(fd_, buffer_.data() + at, buffer_.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw system_error(errno, "cannot write the output", path_);
    at += static_cast<std::size_t>(n);
  }
  buffer_.clear();
}

void OutputFile::replace(std::uint64_t offset, std::string_view bytes) {
  flush();
  while (!bytes.empty()) {
    const ssize_t n = pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw system_error(errno, "cannot write the output", path_);
    offset += static_cast<std::uint64_t>(n);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void OutputFile::publish() {
  flush();
  if (fsync(fd_) != 0 && errno != EINVAL && errno != EROFS)
    throw system_error(errno, "cannot sync", path_);
  const int closed = close(fd_);
  fd_ = -1;
  if (closed != 0) throw system_error(errno, "cannot close", path_);
  rename_into_place(temporary_, path_, overwrite_);
  temporary_.clear();
}

void move_into_place(const std::string& from, const std::string& to, bool overwrite) {
  const int file = open(from.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) throw system_error(errno, "cannot open the finished output", from);
  const int synced = fsync(file);
  const int reason = errno;
  close(file);
  if (synced != 0 && reason != EINVAL && reason != EROFS)
    throw system_error(reason, "cannot sync", to);
  rename_into_place(from, to, overwrite);
}

}  // namespace ptin::tools
