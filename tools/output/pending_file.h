// SPDX-License-Identifier: GPL-3.0-or-later
//
// The temporary name of an output that somebody else writes (GDAL, SQLite): complete or absent.
#pragma once

#include <string>

#include "tools/output/temporary_path.h"

namespace ptin::tools {

/// A name beside the target, with the same extension, that becomes the target or disappears.
class PendingFile {
 public:
  /// @throws Error as check_output
  PendingFile(std::string path, bool overwrite);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] const std::string& temporary() const noexcept { return temporary_.path(); }

  /// Syncs the temporary file, renames it, syncs the folder, and removes the side files. With
  /// `overwrite` the companions of the file that it replaces are removed first.
  /// REQUIRES: the temporary file is written and closed.
  /// @throws Error resource_exhausted, io_error; invalid_argument when the target has appeared
  /// meanwhile and `overwrite` is off
  void publish();

 private:
  std::string path_, target_;  ///< `path_` as given, for messages; `target_` where it leads.
  TemporaryPath temporary_;    ///< With the side files that GDAL and SQLite keep beside it.
  bool overwrite_;
};

}  // namespace ptin::tools
