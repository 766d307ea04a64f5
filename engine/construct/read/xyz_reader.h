// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as text: one a line, three numbers or more, read as a stream.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/grid/source_point.h"

namespace ptin {

using XyzPoint = SourcePoint;

/// Reads points from CSV or XYZ text. Numbers have decimal points; lines end in LF or CR LF; empty
/// lines and comments ('#') are passed over. The first other line decides
///   - the separator: semicolons where it has any, else commas, else spaces and tabs;
///   - the number of fields, which is that of all lines;
///   - whether it is a header, which it is when its first field is no number. A header names the
///     columns (read/column_names.h); without a header x, y and z are the first three.
/// Further columns are passed over. A file that is_packed() (read/input_kind.h) is unpacked while
/// it is read. Not thread-safe.
class XyzReader {
 public:
  /// @throws Error  not_found, io_error  the file cannot be opened
  explicit XyzReader(std::string path);
  /// Reads `text`, which it keeps, instead of a file; `name` stands for the path in errors.
  XyzReader(std::string name, std::string text);
  ~XyzReader();
  XyzReader(const XyzReader&) = delete;
  XyzReader& operator=(const XyzReader&) = delete;

  /// The next point; false at the end.
  /// @throws Error  invalid_argument  a line has another number of fields, or no number, NaN or an
  ///                                  infinite one where one belongs; a header lacks a column; a
  ///                                  line is longer than 64 KiB. The context is "path:line".
  ///                io_error          the file cannot be read on, or is damaged (.gz)
  /// Cost: about 0.1 us a line; 1 MiB of memory whatever the file's size.
  [[nodiscard]] bool next(XyzPoint& point);

  /// Lines read so far, headers, comments and empty lines counted.
  [[nodiscard]] std::uint64_t line() const noexcept { return line_; }
  /// Bytes of the file read so far; 0 where the file is packed, since they are not known.
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }

 private:
  struct File;
  [[nodiscard]] bool next_line(std::string_view& line);
  void fill();
  void split(std::string_view line);
  void begin(std::string_view line);
  void find_columns();
  [[nodiscard]] Decimal number(int role) const;
  [[noreturn]] void refuse(const std::string& sentence) const;

  std::string path_;
  std::unique_ptr<File> file_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< Where the part of buffer_ that is still to be read begins.
  bool at_end_ = false;
  std::uint64_t line_ = 0;
  std::uint64_t bytes_read_ = 0;

  char separator_ = '\0';  ///< '\0' until the first line, ' ' for spaces and tabs.
  bool header_ = false;
  std::array<std::size_t, 3> columns_ = {0, 1, 2};
  std::size_t field_count_ = 0;
  std::vector<std::string_view> fields_;
};

}  // namespace ptin
