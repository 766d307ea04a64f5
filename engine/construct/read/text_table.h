// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text as a table: CSV and its like, a row a line, read as a stream.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/construct/read/declared_comments.h"
#include "engine/construct/read/point_part.h"
#include "engine/error.h"

namespace ptin {

/// Thrown where a part of a text has quotes: a quoted field may hold line ends, so that nobody knows
/// from the middle of a text where its rows begin. The text is to be read as a whole.
class QuotesInPart : public Error {
 public:
  explicit QuotesInPart(const std::string& path)
      : Error(ErrorCode::internal, "a text with quotes is read in parts", path) {}
};

/// Reads rows of fields from text. Lines end in LF, CR LF or a CR alone; empty lines and comments
/// (lines that begin with '#', '%', '!', '>' or "//") are passed over, and so are a byte order mark of
/// UTF-8 and Excel's first line "sep=;". The first other line decides
///   - the separator: semicolons where it has any, else commas, else tabs, unless two numbers stand
///     between them, else spaces; spaces in any number count as one, and where they separate so do
///     tabs;
///   - the number of fields, which is that of all rows;
///   - whether it is a header, which it is when none of its fields begins as a number does, or when
///     it names a column for x and one for y (read/column_names.h). Where it is none, the last
///     comment before it that names columns is the header (read/text_header.h).
/// A field may be quoted by RFC 4180: between quotes separators, line ends and '#' are text, and
/// two quotes are one. Blanks around a field are no part of it. A file that is_packed()
/// (read/input_kind.h) is unpacked while it is read. Not thread-safe.
class TextTable {
 public:
  /// @throws Error  not_found, io_error  the file cannot be opened
  ///                invalid_argument     it is a folder, or is_packed() and has no byte
  explicit TextTable(std::string path) : TextTable(std::move(path), PointPart{}) {}
  /// Reads a part of a text that is_packed() not: its rows, by the separator and the header of the
  /// whole. Lines are named by their number in the whole.
  /// @throws Error  QuotesInPart, also from next() and refuse()
  TextTable(std::string path, const PointPart& part);
  /// Reads `text`, which it keeps; `name` stands for the path in errors.
  TextTable(std::string name, std::string text);
  /// Reads `in`, which outlives the table.
  TextTable(std::string name, std::istream& in);
  ~TextTable();
  TextTable(const TextTable&) = delete;
  TextTable& operator=(const TextTable&) = delete;

  /// The names of the columns; empty where there is no header. Reads the first row of the text when
  /// it was not read yet, and line() is then its line.
  /// @throws Error as next()
  [[nodiscard]] const std::vector<std::string>& header();
  /// True where the header is a comment.
  [[nodiscard]] bool is_told_by_comment() const noexcept { return is_told_by_comment_; }

  /// Declarations of the comments before the first row; all of it is known when the header is.
  [[nodiscard]] const DeclaredComments& declared() const noexcept { return declared_; }

  /// From here on a row may have more fields than the first one: what follows the last column goes
  /// on in it, as a comma in a description does, where that column begins with no number.
  void let_last_go_on() noexcept { may_last_go_on_ = true; }

  /// From here on next() hands out rows that have another number of fields than the first one, too.
  void let_rows_misfit() noexcept { may_misfit_ = true; }
  /// The fault of the number of fields of the row that was read last; "" for none.
  [[nodiscard]] std::string misfit() const;
  [[nodiscard]] bool is_misfit() const;

  /// Reads the next row below the header; false at the end.
  /// @throws Error  invalid_argument  a row has another number of fields, and may not; the text is UTF-16 or
  ///                                  UTF-32; a quoted field does not end, or goes on behind its end; a row is longer than 64 KiB.
  ///                                  The context is "path:line".
  ///                io_error          the text cannot be read on, or is damaged (.gz)
  /// Cost: about 50 ns a line; 1 MiB of memory whatever the text's size.
  [[nodiscard]] bool next();

  /// The fields of the row that was read last, without quotes and the blanks around them. Valid
  /// until the next row is read.
  [[nodiscard]] std::span<const std::string_view> fields() const noexcept { return fields_; }
  /// Fields of the first line, and so of each row.
  [[nodiscard]] std::size_t field_count() const noexcept { return field_count_; }

  /// True for a whole text, and for a part that has its first row.
  [[nodiscard]] bool begins_text() const noexcept { return part_.begin == 0; }
  [[nodiscard]] bool is_whole() const noexcept { return part_.is_whole(); }
  /// The lines read so far, the part's alone.
  [[nodiscard]] std::uint64_t lines() const noexcept { return line_; }
  /// The line that the row read last begins in, from 1; in a part, from its first.
  [[nodiscard]] std::uint64_t line() const noexcept { return row_line_; }
  /// Bytes of the text, or of its part, before the row that was read last; 0 where the file is
  /// packed, since they are not known.
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_ - first_byte_; }

  /// @throws Error  invalid_argument  with this sentence, and "path:line" of the row read last
  [[noreturn]] void refuse(const std::string& sentence) const;

 private:
  struct File;
  void fill();
  void move_to_part();
  void seek_line(std::uint64_t from);
  [[nodiscard]] std::uint64_t lines_before() const;
  [[nodiscard]] bool add_line();
  [[nodiscard]] bool next_row();
  [[nodiscard]] bool split();
  [[nodiscard]] bool split_quoted(std::string_view row);
  void split_unquoted(std::string_view row);
  [[nodiscard]] bool is_blank(char c) const noexcept;
  [[nodiscard]] bool is_separator(char c) const noexcept;
  [[nodiscard]] std::string_view without_blanks(std::string_view text) const noexcept;
  void begin();
  void note_comment(std::string_view text);
  [[nodiscard]] bool goes_on_in_last() const;

  std::string path_;
  PointPart part_;
  bool has_moved_ = false;        ///< To the begin of a part that is not the first.
  std::uint64_t first_byte_ = 0;  ///< Where the first line of such a part begins.
  std::unique_ptr<File> file_;
  std::string buffer_;
  std::size_t begin_ = 0;      ///< Where the row begins in buffer_.
  std::size_t row_bytes_ = 0;  ///< Bytes of the row, with its line ends.
  std::string_view row_;       ///< Without the last line end.
  bool at_end_ = false;
  std::uint64_t line_ = 0;        ///< Lines read so far.
  std::uint64_t row_line_ = 0;    ///< The line that the row begins in.
  std::uint64_t bytes_read_ = 0;  ///< Where the row begins in the text.

  bool begun_ = false;       ///< The first row was read.
  bool is_pending_ = false;  ///< It is no header, and next() has still to return it.
  char separator_ = '\0';    ///< ' ' for spaces and tabs.
  std::size_t field_count_ = 0;
  std::vector<std::string> header_;
  std::vector<std::string> comments_;  ///< Before the first row, until it was read.
  DeclaredComments declared_;
  bool is_told_by_comment_ = false;
  bool may_last_go_on_ = false, may_misfit_ = false;
  std::vector<std::string_view> fields_;
  std::string unquoted_;  ///< What quoted fields of the row hold.
};

/// At most 40 characters of a field in quotes, others than printable ones replaced, for messages.
[[nodiscard]] std::string shown_field(std::string_view field);

/// What is wrong with a field that should be a number and is none, as "is no number; ...", for
/// messages: it is empty, or has a decimal comma.
[[nodiscard]] std::string why_no_number(std::string_view field);

}  // namespace ptin
