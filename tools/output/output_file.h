// SPDX-License-Identifier: GPL-3.0-or-later
//
// An output file that is complete or absent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "storage/file/file_layer.h"

namespace ptin::tools {

/// The name that an output really gets: `path`, or where its links lead, so that the link stays and
/// what it names is replaced.
/// @throws Error invalid_argument  under /dev (but for /dev/shm) or /proc, where a rename would put
///                                 a file in the place of a device or of standard output
///               io_error          links go in a circle
[[nodiscard]] std::string output_target(const std::string& path);

/// Called before the work, so that nobody waits for an answer that cannot be kept.
/// @throws Error  as output_target(); invalid_argument when `path` exists and `overwrite` is off,
///                is no file, or is -, standard output; not_found when its folder does not exist
void check_output(const std::string& path, bool overwrite);

/// Syncs the finished file `from` and gives it the name `to`, in one step; `from` is in the same
/// file system.
/// @throws Error io_error (also when the folder cannot be synced: the file has its name then);
/// invalid_argument when `to` exists and `overwrite` is off
void move_into_place(const std::string& from, const std::string& to, bool overwrite,
                     FileLayer& files = FileLayer::system());

/// Writes beside the target under a temporary name; publish() syncs and renames. Destroyed without
/// publish(), it removes what it wrote: the target's name never shows a part.
class OutputFile {
 public:
  /// @throws Error  as check_output; io_error when the folder is not writable
  OutputFile(std::string path, bool overwrite, FileLayer& files = FileLayer::system());
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// Appends; buffered.  @throws Error resource_exhausted (disk full), io_error
  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Appends the bytes of a trivially copyable value, as this (little-endian) machine holds them.
  template <typename T>
  void write_value(const T& value) {
    write(&value, sizeof value);
  }

  /// Writes over bytes that were written before: a header whose counts are known at the end.
  /// @throws Error as write
  void replace(std::uint64_t offset, std::string_view bytes);

  /// Makes the file appear under its name; with `overwrite` the companions of what it replaces go
  /// first (tools/output/companion_files.h).  @throws Error resource_exhausted, io_error (also when
  /// the folder cannot be synced: the file has its name then); invalid_argument when the target
  /// appeared meanwhile and `overwrite` is off
  void publish();

 private:
  void flush();

  FileLayer& files_;
  std::string path_, target_;  ///< As given, for messages; where it leads.
  std::string temporary_;
  bool overwrite_;
  int fd_ = -1;
  std::vector<char> buffer_;
};

}  // namespace ptin::tools
