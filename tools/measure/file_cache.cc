// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/file_cache.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "engine/error.h"
#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr long kNfsMagic = 0x6969, kXfsMagic = 0x58465342, kZfsMagic = 0x2fc12fc1;
constexpr std::array<std::pair<long, const char*>, 10> kFileSystems = {
    {{TMPFS_MAGIC, "tmpfs"},
     {RAMFS_MAGIC, "ramfs"},
     {EXT4_SUPER_MAGIC, "ext4"},
     {BTRFS_SUPER_MAGIC, "btrfs"},
     {OVERLAYFS_SUPER_MAGIC, "overlayfs"},
     {F2FS_SUPER_MAGIC, "f2fs"},
     {V9FS_MAGIC, "9p"},
     {kNfsMagic, "nfs"},
     {kXfsMagic, "xfs"},
     {kZfsMagic, "zfs"}}};

/// Bytes of a range of the file that are in the cache. REQUIRES: `offset` is a multiple of a page.
std::uint64_t resident_in(int fd, std::uint64_t offset, std::size_t bytes,
                          const std::string& path) {
  void* const mapping =
      ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
  if (mapping == MAP_FAILED) throw system_error(errno, "cannot map the file into memory", path);
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> state((bytes + page - 1) / page);
  const int result = ::mincore(mapping, bytes, state.data());
  const int failure = errno;
  ::munmap(mapping, bytes);
  if (result != 0) throw system_error(failure, "cannot ask what is in the page cache of", path);
  return page * static_cast<std::uint64_t>(
                    std::count_if(state.begin(), state.end(), [](auto s) { return (s & 1) != 0; }));
}

}  // namespace

FileCache::FileCache(const std::string& path)
    : path_(path), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (fd_ < 0) throw system_error(errno, "cannot open", path);
  struct stat seen {};
  if (::fstat(fd_, &seen) != 0) {
    const int failure = errno;
    ::close(fd_);
    throw system_error(failure, "cannot look at the file", path);
  }
  bytes_ = static_cast<std::uint64_t>(seen.st_size);
  device_ = seen.st_dev;
  owner_ = seen.st_uid;
}

FileCache::~FileCache() { ::close(fd_); }

std::uint64_t FileCache::resident_bytes() const {
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 30;  // 256 KiB of answers
  std::uint64_t resident = 0;
  for (std::uint64_t at = 0; at < bytes_; at += kPiece) {
    resident +=
        resident_in(fd_, at, static_cast<std::size_t>(std::min(kPiece, bytes_ - at)), path_);
  }
  return resident;
}

std::uint64_t FileCache::drop() const {
  std::uint64_t left = 0;
  for (int i = 0; i < 10; ++i) {
    if (::fdatasync(fd_) != 0 && errno == EIO) throw system_error(errno, "cannot sync", path_);
    ::posix_fadvise(fd_, 0, 0, POSIX_FADV_DONTNEED);
    left = resident_bytes();
    if (left == 0) break;
    // Pages that are just being read or written are dropped in a later round.
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return left;
}

bool FileCache::may_look() const noexcept {
  const auto user = ::geteuid();
  return user == 0 || user == owner_ || ::faccessat(AT_FDCWD, path_.c_str(), W_OK, AT_EACCESS) == 0;
}

std::string FileCache::why_never_cold() const {
  const std::string kind = file_system();
  if (kind == "tmpfs" || kind == "ramfs")
    return "it lies in memory (" + kind + "), and no disk is read";
  if (!may_look())
    return "this user may not see what of it is in the page cache: mincore tells only the owner of "
           "a file, and who may write it";
  const std::uint64_t left = drop();
  if (left == 0) return {};
  return human_bytes(left) +
         " of it stay in the page cache: another program uses it, or the file system keeps it";
}

std::string FileCache::file_system() const {
  struct statfs seen {};
  if (::fstatfs(fd_, &seen) != 0) return {};
  const auto* const known = std::find_if(kFileSystems.begin(), kFileSystems.end(),
                                         [&](const auto& k) { return k.first == seen.f_type; });
  return known == kFileSystems.end() ? "" : known->second;
}

}  // namespace ptin::tools
