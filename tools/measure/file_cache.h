// SPDX-License-Identifier: GPL-3.0-or-later
//
// A file's share of the system's page cache: what of it is there, and dropping it.
#pragma once

#include <cstdint>
#include <string>

namespace ptin::tools {

/// A file, open for as long as the object lives, so that it is looked at even when another file
/// gets its name. Threads: const functions may be called at once.
class FileCache {
 public:
  /// @throws Error not_found, io_error
  explicit FileCache(const std::string& path);
  FileCache(const FileCache&) = delete;
  FileCache& operator=(const FileCache&) = delete;
  ~FileCache();

  [[nodiscard]] std::uint64_t file_bytes() const noexcept { return bytes_; }

  /// Drops the file from the cache (fdatasync, then posix_fadvise DONTNEED, up to 10 times within
  /// 20 ms). Returns the bytes that are there all the same: 0 means that the file is cold. What is
  /// mapped stays, so close every store on the file before.
  /// @throws Error io_error
  [[nodiscard]] std::uint64_t drop() const;

  /// Bytes of the file that are in the cache, by mincore: whole pages of the system. Where this
  /// user may not know (who neither owns the file nor may write it), all of it.
  /// @throws Error io_error.  Cost: 13 ms a gibibyte of the file.
  [[nodiscard]] std::uint64_t resident_bytes() const;

  /// Why the file cannot be made cold, as the end of a sentence; empty when it can be. Drops it.
  /// @throws Error io_error
  [[nodiscard]] std::string why_never_cold() const;

  /// The file system by its name ("ext4", "tmpfs"); empty when it is none of those that are known.
  [[nodiscard]] std::string file_system() const;
  /// Whether the other file lies on the same file system.
  [[nodiscard]] bool is_beside(const FileCache& other) const noexcept {
    return device_ == other.device_;
  }

 private:
  [[nodiscard]] bool may_look() const noexcept;

  std::string path_;
  int fd_;
  std::uint64_t bytes_ = 0, device_ = 0;
  std::uint32_t owner_ = 0;
};

}  // namespace ptin::tools
