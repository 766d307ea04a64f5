// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as text, for `verify --against`. The rules are those that
// engine/construct/read/xyz_reader.h states. The code is independent of that reader on purpose: a
// fault that both shared would be found by nobody.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/read/declared_comments.h"

namespace ptin::tools {

/// The points of one file of text. Lines end in LF, CR LF or CR. The first line that is neither empty
/// nor a comment ('#', '%', '!', '>', "//") decides the separator (semicolon, else comma, else tab,
/// else blanks), the number of fields, and whether that line is a header: no field of it begins as a
/// number, or it names columns for x and y; else the last comment before it that names columns is
/// one. Empty fields between semicolons, commas or tabs count, and fields may be quoted as in RFC
/// 4180. Where the last column has a name that is no coordinate's, it may hold separators. A byte
/// order mark is passed over. A file whose name ends in .gz, in any case, is unpacked on the way.
class TextSamples {
 public:
  /// @param columns         The names of the columns that the build was given; empty: none.
  /// @param is_nodata_told  The build was given a height that means none: one that comments declare
  ///                        does not count.
  /// @throws Error not_found, io_error
  TextSamples(std::string path, const std::vector<std::string>& columns, bool is_nodata_told);
  TextSamples(const TextSamples&) = delete;
  TextSamples& operator=(const TextSamples&) = delete;
  ~TextSamples();

  /// A line that stands for a point: its numbers, or why they cannot be read.
  struct Line {
    std::uint64_t number = 0;  ///< From 1.
    std::array<double, 3> point{};
    std::string misfit;  ///< Empty where `point` holds.
  };
  /// Reads the next such line into `line`, but for those that comments say have no height; false at the
  /// end.
  /// @throws Error invalid_argument  the first line names no column for x, y or z, or has too few
  ///                                 fields; a line is longer than 64 KiB, or its quotes do not end
  ///               io_error          the file cannot be read on
  [[nodiscard]] bool next(Line& line);

 private:
  struct File;
  /// The next line, with those that a quoted field of it goes on in.
  [[nodiscard]] bool next_text(std::string& text);
  [[nodiscard]] bool next_line(std::string_view& line);
  void fill();
  void split(std::string_view text);
  /// Looks at the first line; true when it is a header.
  [[nodiscard]] bool begin(std::string_view text);
  void choose_columns(const std::vector<std::string>& names);
  [[nodiscard]] bool names_columns(std::string_view comment, std::vector<std::string>& names) const;
  [[nodiscard]] std::vector<std::string> names_in_comments() const;
  void read_numbers(Line& line) const;
  [[noreturn]] void refuse(const std::string& sentence) const;

  std::string path_;
  std::unique_ptr<File> file_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< Where the part of the buffer begins that is left.
  bool at_end_ = false;
  std::uint64_t number_ = 0;        ///< Lines so far.
  std::uint64_t first_ = 0;         ///< The line that the text of next_text() begins in.
  std::vector<std::string> given_;  ///< Names of columns.
  char separator_ = '\0';           ///< '\0' before the first line, ' ' for blanks and tabs.
  std::array<std::size_t, 3> columns_{0, 1, 2};
  std::size_t field_count_ = 0;
  bool may_go_on_ = false;             ///< The last column has a name, and is no coordinate.
  std::vector<std::string> comments_;  ///< Before the first line of fields.
  bool is_nodata_told_;
  DeclaredComments declared_;
  std::vector<std::string> fields_;
};

}  // namespace ptin::tools
