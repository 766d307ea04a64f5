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

/// The system's files, as virtual functions that tests replace. Every function returns 0 or the
/// errno value; none throws. Threads: it has no state, so functions may be called at once.
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
  /// Creates a file without a name in a folder, for reading and writing. It is gone when its
  /// descriptor is closed, however the process ends. File systems that cannot do it answer
  /// EOPNOTSUPP.
  virtual int create_nameless(const std::string& folder, int& fd) noexcept;
  /// Opens an existing file for reading and writing.
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
  /// Cuts the file to `bytes`, or lengthens it with zeros up to there.
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

/// A file that is being written. The destructor closes it, and removes it too unless it is a kept
/// one or was published. Errors are ptin::Error and name the file: resource_exhausted when the disk
/// is full, io_error otherwise.
class ScratchFile {
 public:
  enum class Kept { kNew, kExisting };
  /// kExisting when something of this name is there, else kNew.
  /// @throws Error io_error  the system does not say whether it is (storage/file/file_questions.h)
  [[nodiscard]] static Kept kept_at(const std::string& path);
  /// Creates (kNew) or opens (kExisting) a kept file: one with the name `path`, which stays when
  /// the object goes. It holds work that can be taken up again. `files` is borrowed.
  /// @throws Error not_found, io_error (also: kNew, and the file exists), resource_exhausted
  ScratchFile(FileLayer& files, const std::string& path, Kept kept);
  /// Creates `folder`/`.stem.PID-N.tmp` with the first N that is free. With `nameless` on, the file
  /// has no name, so that nothing can be left behind; a file system without nameless files gets one
  /// whose name is removed at once. `files` is borrowed.
  /// @throws Error not_found (no such folder), io_error, resource_exhausted
  ScratchFile(FileLayer& files, const std::string& folder, const std::string& stem, bool nameless);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  void write_at(std::span<const std::byte> bytes, std::uint64_t offset);
  void read_at(std::span<std::byte> bytes, std::uint64_t offset) const;
  /// Copies `bytes` bytes of `from`, from `from_offset` on, to `offset` here, a mebibyte at a time.
  /// The ranges must not overlap when both are of this file.
  void copy_from(const ScratchFile& from, std::uint64_t from_offset, std::uint64_t bytes,
                 std::uint64_t offset);
  [[nodiscard]] std::uint64_t size() const;
  void reserve(std::uint64_t offset, std::uint64_t bytes);
  void truncate(std::uint64_t bytes);
  void sync();
  /// Closes a kept file that nothing more is done with. File systems over a network report only now
  /// what they could not write.
  void close();
  /// Syncs, closes, renames onto `target` and syncs the folder. With `replace` off an existing
  /// target is invalid_argument.
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
