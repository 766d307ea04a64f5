// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/output_file.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "tools/output/companion_files.h"
#include "tools/refused_memory.h"

namespace ptin::tools {

namespace {

static_assert(std::endian::native == std::endian::little,
              "write_value() states little-endian files");

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

Error exists_already(const std::string& path) {
  return {ErrorCode::invalid_argument,
          "exists already; give another name, or --overwrite to replace it", path};
}

/// Syncs what was written. Some file systems cannot sync a file; there is nothing more to do there.
int sync_content(FileLayer& files, int fd) {
  const int failure = files.sync(fd);
  return failure == EINVAL || failure == EROFS ? 0 : failure;
}

/// Renames in one step, and syncs the folder.
void rename_into_place(FileLayer& files, const std::string& from, const std::string& to,
                       bool overwrite) {
  int failure = files.rename(from, to, overwrite);
  if (failure == EEXIST) throw exists_already(to);
  if (failure != 0) throw system_error(failure, "cannot rename the finished output", to);
  failure = files.sync_folder(folder_of(to));
  if (failure != 0) {
    throw system_error(
        failure, "the file is complete, but its name may not survive a power cut: cannot sync",
        folder_of(to));
  }
}

namespace fs = std::filesystem;

bool is_within(const fs::path& folder, const fs::path& other) {
  return std::mismatch(other.begin(), other.end(), folder.begin(), folder.end()).first ==
         other.end();
}

/// True for a path below /proc or /dev, but for /dev/shm: names there stand for devices and for
/// what a process has open.
bool is_of_the_system(const fs::path& path) {
  std::error_code unknown;  // A missing folder is found by check_output().
  const fs::path folder = fs::canonical(folder_of(path.string()), unknown);
  return !unknown && (is_within(folder, "/proc") ||
                      (is_within(folder, "/dev") && !is_within(folder, "/dev/shm")));
}

}  // namespace

std::string output_target(const std::string& path) {
  constexpr int kMostLinks = 40;  // as the kernel
  fs::path at(path);
  for (int i = 0; i < kMostLinks; ++i) {
    if (is_of_the_system(at)) {
      throw Error(ErrorCode::invalid_argument,
                  "leads under /dev or /proc, where a finished file cannot be put; give a file "
                  "name, or - where the command can write to standard output",
                  path);
    }
    std::error_code failed;
    if (!fs::is_symlink(fs::symlink_status(at, failed))) return at.string();
    const fs::path to = fs::read_symlink(at, failed);
    if (failed) throw system_error(failed.value(), "cannot follow the link", at.string());
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  throw system_error(ELOOP, "cannot follow the links of the output", path);
}

void check_output(const std::string& path, bool overwrite) {
  if (path == "-") {
    throw Error(ErrorCode::invalid_argument,
                "standard output does not take this; give a file name (./- for one of that name)");
  }
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode))
      throw Error(ErrorCode::invalid_argument, "is a folder; give a file name", path);
    if (!S_ISREG(status.st_mode)) {
      throw Error(ErrorCode::invalid_argument,
                  "is a device or a pipe, which a finished file cannot replace; give a file name",
                  path);
    }
    static_cast<void>(output_target(path));
    if (!overwrite) throw exists_already(path);
    return;
  }
  const std::string folder = folder_of(output_target(path));
  if (stat(folder.c_str(), &status) != 0) {
    throw Error(ErrorCode::not_found, "the folder of the output does not exist; make it first",
                folder);
  }
}

std::string target_of(const std::string& path, bool overwrite) {
  check_output(path, overwrite);
  return output_target(path);
}

OutputFile::OutputFile(std::string path, bool overwrite, FileLayer& files)
    : files_(files),
      path_(std::move(path)),
      target_(target_of(path_, overwrite)),
      temporary_(target_ + ".tmp" + std::to_string(getpid())),
      overwrite_(overwrite) {
  buffer_.reserve(kBufferBytes);
  fd_ = open(temporary_.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd_ < 0) {
    const int failure = errno;
    temporary_.keep();  // what is there is not ours
    throw system_error(failure, "cannot create the output", path_);
  }
}

OutputFile::~OutputFile() {
  if (fd_ >= 0) close(fd_);
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
  require_memory_given(path_);  // without it a CRS may have lost its name on the way
  flush();
  const int failure = sync_content(files_, fd_);
  if (failure != 0) throw system_error(failure, "cannot sync", path_);
  const int closed = close(fd_);
  fd_ = -1;
  if (closed != 0) throw system_error(errno, "cannot close", path_);
  if (overwrite_) remove_companions(target_);
  rename_into_place(files_, temporary_.path(), target_, overwrite_);
  temporary_.keep();
}

void move_into_place(const std::string& from, const std::string& to, bool overwrite,
                     FileLayer& files) {
  int fd = -1;
  int failure = files.open(from, fd);
  if (failure != 0) throw system_error(failure, "cannot open the finished output", from);
  failure = sync_content(files, fd);
  static_cast<void>(files.close(fd));
  if (failure != 0) throw system_error(failure, "cannot sync", to);
  rename_into_place(files, from, to, overwrite);
}

}  // namespace ptin::tools
