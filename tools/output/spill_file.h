// SPDX-License-Identifier: GPL-3.0-or-later
//
// A nameless temporary file: written once, then read back from its beginning.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/file/file_layer.h"

namespace ptin::tools {

/// Bytes on disk that nobody else sees. It has no name, so nothing is left behind however the
/// program ends. One thread.
class SpillFile {
 public:
  /// @param output  The file that the bytes are for: the spill file lies in its folder, and errors
  ///                name it.
  /// @throws Error not_found, io_error, resource_exhausted
  explicit SpillFile(std::string output, FileLayer& files = FileLayer::system());

  /// Appends; buffered.  @throws Error resource_exhausted (disk full), io_error
  void write(const void* data, std::size_t bytes);
  /// The next bytes, from the beginning on, at most a mebibyte at a time; empty at the end. Valid
  /// until the next call. REQUIRES: write() is not called afterwards.  @throws Error as write
  [[nodiscard]] std::span<const char> read();

 private:
  void flush();

  std::string output_;
  ScratchFile file_;
  bool reading_ = false;
  std::uint64_t written_ = 0, read_ = 0;
  std::vector<char> buffer_;
};

}  // namespace ptin::tools
