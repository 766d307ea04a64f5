// SPDX-License-Identifier: GPL-3.0-or-later
//
// The temporary files of a source of points while it is read and sorted.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "engine/construct/scratch/array_file.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// Where they lie, and what they are called. Threads: any number.
struct PointFiles {
  FileLayer& files;
  std::string folder;
  /// Called with the path of a file that another process may have written, before it is opened; may be
  /// empty.
  std::function<void(const std::string& path)> await{};
  /// True for a process that does not direct the build: buckets, which stay, are made durable by the
  /// task that writes them.
  bool syncs_buckets = false;

  /// The path of file `number` of a kind.
  [[nodiscard]] std::string path(const char* kind, std::size_t number) const;
  /// True for such a path.
  [[nodiscard]] bool is_one(const std::string& path) const;
  /// Opens what another task wrote.
  /// @throws Error  not_found, io_error; ArrayFileReader: corruption
  [[nodiscard]] std::unique_ptr<ScratchFile> open(const std::string& path) const;
  [[nodiscard]] ArrayFileReader open(const std::string& path, const ArrayFileFacts& facts) const;

  /// Removes all files that path() names, of this build or of an interrupted one.
  /// @throws Error io_error
  void remove_all() const;
  /// Those of one kind.
  void remove_all(const std::string& kind) const;
};

/// Removes all files whose names begin with `path`.  @throws Error not_found (the folder), io_error
void remove_files(FileLayer& files, const std::string& path);

}  // namespace ptin
