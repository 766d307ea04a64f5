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
#include "tools/output/byte_sink.h"
#include "tools/output/temporary_path.h"

namespace ptin::tools {

/// The path at which an output is put: `path`, or where its links lead, so that a link stays and
/// the file that it names is replaced.
/// @throws Error invalid_argument  under /dev (but for /dev/shm) or /proc, where a rename would put
///                                 a file in the place of a device or of standard output
///               io_error          links go in a circle
[[nodiscard]] std::string output_target(const std::string& path);

/// Refuses an output that cannot be put in its place. Called before the work, so that nobody waits
/// for an answer that cannot be kept.
/// @throws Error  as output_target(); invalid_argument when `path` exists and `overwrite` is off,
///                is no regular file, or is "-" (standard output); not_found when its folder does
///                not exist
void check_output(const std::string& path, bool overwrite);

/// The target of an output that can be put there.  @throws Error as check_output()
[[nodiscard]] std::string target_of(const std::string& path, bool overwrite);

/// Syncs the finished file `from`, then gives it the name `to` in one step.
/// REQUIRES: both names are in one file system.
/// @throws Error io_error  also: the folder cannot be synced; then the file has its name
/// @throws Error invalid_argument  `to` exists and `overwrite` is off
void move_into_place(const std::string& from, const std::string& to, bool overwrite,
                     FileLayer& files = FileLayer::system());

/// Writes a file beside the target under a temporary name; publish() syncs and renames it.
/// Destroyed without publish(), it removes what it wrote: the target's name never shows a part.
class OutputFile : public ByteSink {
 public:
  /// @throws Error  as check_output; io_error when the folder is not writable
  OutputFile(std::string path, bool overwrite, FileLayer& files = FileLayer::system());
  ~OutputFile() override;

  using ByteSink::write;
  /// Appends; buffered.
  void write(const void* data, std::size_t bytes) override;
  void replace(std::uint64_t offset, std::string_view bytes) override;

  /// Makes the file appear under its name. With `overwrite` the companions of the file that it
  /// replaces are removed first (tools/output/companion_files.h).
  /// @throws Error resource_exhausted  the disk is full; memory was refused (tools/refused_memory.h)
  /// @throws Error io_error  also: the folder cannot be synced; then the file has its name
  /// @throws Error invalid_argument  the target has appeared meanwhile and `overwrite` is off
  void publish();

 private:
  void flush();

  FileLayer& files_;
  std::string path_, target_;  ///< `path_` as given, for messages; `target_` where it leads.
  TemporaryPath temporary_;
  bool overwrite_;
  int fd_ = -1;
  std::vector<char> buffer_;
};

}  // namespace ptin::tools
