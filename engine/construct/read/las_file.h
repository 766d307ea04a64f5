// SPDX-License-Identifier: GPL-3.0-or-later
//
// The bytes of a LAS file, compressed or not, and its header. Its records are in read/las_records.h.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <cpl_vsi.h>

#include "engine/construct/read/las_reader.h"

namespace ptin {

/// An open LAS file, read at any position.
class LasFile {
 public:
  /// @throws Error not_found, io_error
  explicit LasFile(std::string path);
  ~LasFile();
  LasFile(const LasFile&) = delete;
  LasFile& operator=(const LasFile&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Fills `into` with the bytes from `offset` on.
  /// @throws Error io_error  they cannot be read, or the file ends before
  void read(std::uint64_t offset, std::span<unsigned char> into) const;

 private:
  std::string path_;
  VSILFILE* handle_ = nullptr;
  std::uint64_t bytes_ = 0;
};

/// Bytes of a point of a format, without extra bytes.
[[nodiscard]] std::uint32_t las_format_bytes(int format) noexcept;

/// Reads the header, and checks it against itself and the size of the file.
/// @throws Error as LasReader
[[nodiscard]] LasHeader read_las_header(const LasFile& file);

}  // namespace ptin
