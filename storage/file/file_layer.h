// SPDX-License-Identifier: GPL-3.0-or-later
//
// The few system calls through which files are written, in one place that tests can make fail.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <sys/types.h>

namespace ptin {

/// The system's files. Every function returns 0 or the errno value; none throws.
/// Threads: no state of its own; as safe as the calls it makes.
class FileLayer {
 public:
  FileLayer() = default;
  FileLayer(const FileLayer&) = delete;
  FileLayer& operator=(const FileLayer&) = delete;
  virtual ~FileLayer() = default;

  /// The system itself.
  [[nodiscard]] static FileLayer& system() noexcept;

  /// Creates a file that must not exist yet, for reading and writing; `fd` is valid when 0 is
  /// returned.
  virtual int create(const std::string& path, int& fd) noexcept;
  /// Creates a file without a name in a folder, for reading and writing: it is gone with its
  /// descriptor, however the process ends. File systems that cannot do it answer EOPNOTSUPP.
  virtual int create_nameless(const std::string& folder, int& fd) noexcept;
  /// Opens a file for reading and writing that exists.
  virtual int open(const std::string& path, int& fd) noexcept;
  virtual int close(int fd) noexcept;
  /// May write less than asked for, like pwrite(2).
  virtual int write_at(int fd, std::span<const std::byte> bytes, std::uint64_t offset,
                       std::size_t& written) noexcept;
  /// May read less than asked for, like pread(2); 0 bytes at the end of the file.
  virtual int read_at(int fd, std::span<std::byte> bytes, std::uint64_t offset,
                      std::size_t& read) noexcept;
  /// Reserves space, so that a full disk is known early. File systems that cannot do it answer
  /// EOPNOTSUPP.
  virtual int allocate(int fd, std::uint64_t offset, std::uint64_t bytes) noexcept;
  virtual int size(int fd, std::uint64_t& bytes) noexcept;
  /// Cuts the file to `bytes`, or fills it with zeros up to there.
  virtual int truncate(int fd, std::uint64_t bytes) noexcept;
  virtual int sync(int fd) noexcept;
  /// Puts `from` in the place of `to` in one step. With `replace` off an existing `to` is EEXIST.
  virtual int rename(const std::string& from, const std::string& to, bool replace) noexcept;
  virtual int unlink(const std::string& path) noexcept;
  /// Creates a folder that must not exist yet.
  virtual int make_folder(const std::string& path) noexcept;
  /// Removes a folder that is empty.
  virtual int remove_folder(const std::string& path) noexcept;
  /// Makes the names in a folder durable.
  virtual int sync_folder(const std::string& path) noexcept;
};

/// A file being written: closed when destroyed, removed too unless it is a kept one. Errors are
/// ptin::Error and name the file.
class ScratchFile {
 public:
  enum class Kept { kNew, kExisting };
  /// kExisting when there is something of this name.
  /// @throws Error io_error  that cannot be told
  [[nodiscard]] static Kept kept_at(const std::string& path);
  /// A file of this very name, which stays when the object goes: work that can be taken up again.
  /// @throws Error not_found, io_error, resource_exhausted; also when a new one exists already
  ScratchFile(FileLayer& files, const std::string& path, Kept kept);
  /// Creates `folder`/`.stem.N.tmp` with the first N that is free. With `nameless` on it has no
  /// name, so that nothing can be left behind; where the file system cannot do that, one that is
  /// removed at once.
  /// @throws Error not_found (no such folder), io_error, resource_exhausted
  ScratchFile(FileLayer& files, const std::string& folder, const std::string& stem, bool nameless);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  void write_at(std::span<const std::byte> bytes, std::uint64_t offset);
  void read_at(std::span<std::byte> bytes, std::uint64_t offset) const;
  /// Copies a range of `from` to `offset` here, in pieces. The ranges must not overlap when both
  /// are this file.
  void copy_from(const ScratchFile& from, std::uint64_t from_offset, std::uint64_t bytes,
                 std::uint64_t offset);
  [[nodiscard]] std::uint64_t size() const;
  void reserve(std::uint64_t offset, std::uint64_t bytes);
  void truncate(std::uint64_t bytes);
  void sync();
  /// Syncs, closes, renames onto `target`, syncs the folder. With `replace` off an existing target
  /// is invalid_argument.
  void publish_as(const std::string& target, bool replace);

 private:
  void create_named(const std::string& stem);
  void close_and_remove() noexcept;

  FileLayer& files_;
  std::string folder_;
  std::string path_;  ///< Empty once there is no name to remove.
  bool kept_ = false;
  std::string shown_;
  int fd_ = -1;
};

}  // namespace ptin
