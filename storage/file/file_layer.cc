// SPDX-License-Identifier: GPL-3.0-or-later
#include "storage/file/file_layer.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

// Renames without replacing, on a file system that has no call for it: gives the file its new name
// besides the old one, then removes the old one.
int rename_by_link(const char* from, const char* to) {
  if (::link(from, to) != 0) {
    return errno;
  }
  return ::unlink(from) == 0 ? 0 : errno;
}

}  // namespace

FileLayer& FileLayer::system() noexcept {
  static FileLayer layer;
  return layer;
}

int FileLayer::create(const std::string& path, int& fd) noexcept {
  fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  return fd >= 0 ? 0 : errno;
}

int FileLayer::create_nameless(const std::string& folder, int& fd) noexcept {
  fd = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  // A kernel or a file system that does not know O_TMPFILE takes the call for opening the folder
  // itself, and answers EISDIR or EINVAL.
  return fd >= 0 ? 0 : errno == EISDIR || errno == EINVAL ? EOPNOTSUPP : errno;
}

int FileLayer::open(const std::string& path, int& fd) noexcept {
  fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  return fd >= 0 ? 0 : errno;
}

int FileLayer::close(int fd) noexcept { return ::close(fd) == 0 ? 0 : errno; }

int FileLayer::write_at(int fd, std::span<const std::byte> bytes, std::uint64_t offset,
                        std::size_t& written) noexcept {
  const ssize_t n = ::pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  written = n < 0 ? 0 : static_cast<std::size_t>(n);
  return n < 0 ? errno : 0;
}

int FileLayer::read_at(int fd, std::span<std::byte> bytes, std::uint64_t offset,
                       std::size_t& read) noexcept {
  const ssize_t n = ::pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  read = n < 0 ? 0 : static_cast<std::size_t>(n);
  return n < 0 ? errno : 0;
}

int FileLayer::allocate(int fd, std::uint64_t offset, std::uint64_t bytes) noexcept {
  return ::fallocate(fd, 0, static_cast<off_t>(offset), static_cast<off_t>(bytes)) == 0 ? 0 : errno;
}

int FileLayer::size(int fd, std::uint64_t& bytes) noexcept {
  struct stat status {};
  const int failure = ::fstat(fd, &status) == 0 ? 0 : errno;
  bytes = failure == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  return failure;
}

int FileLayer::truncate(int fd, std::uint64_t bytes) noexcept {
  return ::ftruncate(fd, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
}

int FileLayer::sync(int fd) noexcept { return ::fsync(fd) == 0 ? 0 : errno; }

int FileLayer::rename(const std::string& from, const std::string& to, bool replace) noexcept {
  if (replace) {
    return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
  }
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
    return 0;
  }
  return errno == EINVAL || errno == ENOSYS ? rename_by_link(from.c_str(), to.c_str()) : errno;
}

int FileLayer::unlink(const std::string& path) noexcept {
  return ::unlink(path.c_str()) == 0 ? 0 : errno;
}

int FileLayer::make_folder(const std::string& path) noexcept {
  return ::mkdir(path.c_str(), 0777) == 0 ? 0 : errno;
}

int FileLayer::remove_folder(const std::string& path) noexcept {
  return ::rmdir(path.c_str()) == 0 ? 0 : errno;
}

int FileLayer::sync_folder(const std::string& path) noexcept {
  const int fd = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) {
    return errno;
  }
  // Some file systems cannot sync a folder and say EINVAL; there is nothing more to do there.
  const int result = ::fsync(fd) == 0 || errno == EINVAL ? 0 : errno;
  ::close(fd);
  return result;
}

ScratchFile::Kept ScratchFile::kept_at(const std::string& path) {
  return is_there(path) ? Kept::kExisting : Kept::kNew;
}

ScratchFile::ScratchFile(FileLayer& files, const std::string& folder, const std::string& stem,
                         bool nameless)
    : files_(files), folder_(folder), shown_(folder + "/" + stem) {
  if (!nameless) {
    create_named(stem);
    return;
  }
  int failure = files_.create_nameless(folder, fd_);
  if (failure == 0) {
    return;
  }
  if (failure != EOPNOTSUPP) {
    fd_ = -1;
    throw system_error(failure, "cannot create a file in this folder", folder);
  }
  create_named(stem);
  failure = files_.unlink(path_);
  if (failure != 0) {
    close_and_remove();
    throw system_error(failure, "cannot remove a temporary name", shown_);
  }
  path_.clear();
}

void ScratchFile::create_named(const std::string& stem) {
  const std::string prefix = folder_ + "/." + stem + "." + std::to_string(::getpid()) + "-";
  int failure = EEXIST;
  for (int n = 0; failure == EEXIST && n < 1000; ++n) {
    path_ = prefix + std::to_string(n) + ".tmp";
    failure = files_.create(path_, fd_);
  }
  if (failure != 0) {
    path_.clear();
    throw system_error(failure, "cannot create a file in this folder", folder_);
  }
}

ScratchFile::ScratchFile(FileLayer& files, const std::string& path, Kept kept)
    : files_(files), folder_(folder_of(path)), path_(path), kept_(true), shown_(path) {
  const int failure = kept == Kept::kNew ? files_.create(path_, fd_) : files_.open(path_, fd_);
  if (failure != 0) {
    throw system_error(failure, kept == Kept::kNew ? "cannot create" : "cannot open", path);
  }
}

ScratchFile::~ScratchFile() { close_and_remove(); }

void ScratchFile::close_and_remove() noexcept {
  if (fd_ >= 0) {
    static_cast<void>(files_.close(fd_));
    fd_ = -1;
  }
  if (!path_.empty() && !kept_) {
    static_cast<void>(files_.unlink(path_));
    path_.clear();
  }
}

void ScratchFile::write_at(std::span<const std::byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    std::size_t written = 0;
    const int failure = files_.write_at(fd_, bytes, offset, written);
    if (failure == EINTR) {
      continue;
    }
    if (failure != 0 || written == 0) {
      throw system_error(failure != 0 ? failure : EIO, "cannot write", shown_);
    }
    bytes = bytes.subspan(written);
    offset += written;
  }
}

void ScratchFile::read_at(std::span<std::byte> bytes, std::uint64_t offset) const {
  while (!bytes.empty()) {
    std::size_t read = 0;
    const int failure = files_.read_at(fd_, bytes, offset, read);
    if (failure == EINTR) {
      continue;
    }
    if (failure != 0 || read == 0) {
      throw system_error(failure != 0 ? failure : EIO, "cannot read back", shown_);
    }
    bytes = bytes.subspan(read);
    offset += read;
  }
}

void ScratchFile::copy_from(const ScratchFile& from, std::uint64_t from_offset, std::uint64_t bytes,
                            std::uint64_t offset) {
  std::vector<std::byte> piece(
      static_cast<std::size_t>(std::min<std::uint64_t>(bytes, std::uint64_t{1} << 20)));
  while (bytes > 0) {
    const std::span<std::byte> part(
        piece.data(), static_cast<std::size_t>(std::min<std::uint64_t>(bytes, piece.size())));
    from.read_at(part, from_offset);
    write_at(part, offset);
    from_offset += part.size();
    offset += part.size();
    bytes -= part.size();
  }
}

std::uint64_t ScratchFile::size() const {
  std::uint64_t bytes = 0;
  const int failure = files_.size(fd_, bytes);
  if (failure != 0) {
    throw system_error(failure, "cannot learn the size", shown_);
  }
  return bytes;
}

void ScratchFile::reserve(std::uint64_t offset, std::uint64_t bytes) {
  const int failure = bytes == 0 ? 0 : files_.allocate(fd_, offset, bytes);
  if (failure == ENOSPC || failure == EDQUOT || failure == EFBIG) {
    throw system_error(failure, "cannot reserve " + std::to_string(bytes) + " bytes", shown_);
  }
}

void ScratchFile::truncate(std::uint64_t bytes) {
  const int failure = files_.truncate(fd_, bytes);
  if (failure != 0) {
    throw system_error(failure, "cannot cut to " + std::to_string(bytes) + " bytes", shown_);
  }
}

void ScratchFile::sync() {
  const int failure = files_.sync(fd_);
  if (failure != 0) {
    throw system_error(failure, "cannot sync", shown_);
  }
}

void ScratchFile::close() {
  const int failure = files_.close(std::exchange(fd_, -1));
  if (failure != 0) {
    throw system_error(failure, "cannot close", shown_);
  }
}

void ScratchFile::publish_as(const std::string& target, bool replace) {
  int failure = files_.sync(fd_);
  if (failure != 0) {
    throw system_error(failure, "cannot sync", target);
  }
  failure = files_.close(std::exchange(fd_, -1));
  if (failure != 0) {
    throw system_error(failure, "cannot close", target);
  }
  failure = files_.rename(path_, target, replace);
  if (failure == EEXIST) {
    refuse("the file exists; remove it, or ask for overwriting", target);
  }
  if (failure != 0) {
    throw system_error(failure, "cannot rename the finished file onto this name", target);
  }
  path_.clear();
  const std::string folder = folder_of(target);
  failure = files_.sync_folder(folder);
  if (failure != 0) {
    throw system_error(
        failure, "the file is complete, but its name may not survive a power cut: cannot sync",
        folder);
  }
}

}  // namespace ptin
