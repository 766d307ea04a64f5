// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/text_table.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <istream>
#include <utility>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "engine/construct/grid/decimal.h"
#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/input_kind.h"
#include "engine/construct/read/line_end.h"
#include "engine/construct/read/point_part.h"
#include "engine/construct/read/text_encoding.h"
#include "engine/construct/read/text_header.h"
#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr std::size_t kLongestRow = std::size_t{1} << 16;

/// A text before its header holds hardly more comments than these; the last ones count.
constexpr std::size_t kMostComments = 64;

}  // namespace

struct TextTable::File {
  VSILFILE* handle = nullptr;
  std::istream* stream = nullptr;
  bool packed = false;
  bool on_disk = false;  ///< A file of the system's, whose faults GDAL does not always report.
  ~File() {
    if (handle != nullptr) {
      const GdalSession session;
      VSIFCloseL(handle);
    }
  }
};

TextTable::TextTable(std::string path, const PointPart& part)
    : path_(std::move(path)), part_(part), file_(std::make_unique<File>()) {
  const GdalSession session;
  file_->packed = is_packed(path_);
  file_->on_disk = !file_->packed && !path_.starts_with("/vsi");
  errno = 0;
  file_->handle = VSIFOpenL(((file_->packed ? "/vsigzip/" : "") + path_).c_str(), "rb");
  const int failure = errno;
  VSIStatBufL status;
  const bool is_there = VSIStatL(path_.c_str(), &status) == 0;
  if (is_there && VSI_ISDIR(status.st_mode) != 0) {
    throw Error(ErrorCode::invalid_argument, "is a folder; name a file of text", path_);
  }
  if (is_there && file_->packed && VSI_ISREG(status.st_mode) != 0 && status.st_size == 0) {
    throw Error(ErrorCode::invalid_argument,
                "this file has no byte, and even a packed text of none has some; it was cut short",
                path_);
  }
  if (file_->handle == nullptr) {
    const bool is_refused = failure != 0 && failure != ENOENT && failure != ENOTDIR;
    if (!is_there && !is_refused) {
      throw Error(ErrorCode::not_found, "there is no such file of points", path_);
    }
    throw is_refused ? system_error(failure, "cannot open", path_)
                     : Error(ErrorCode::io_error, session.explain("cannot open"), path_);
  }
  buffer_.reserve(kBufferBytes + kLongestRow);
}

TextTable::TextTable(std::string name, std::string text)
    : path_(std::move(name)),
      file_(std::make_unique<File>()),
      buffer_(std::move(text)),
      at_end_(true) {}

TextTable::TextTable(std::string name, std::istream& in)
    : path_(std::move(name)), file_(std::make_unique<File>()) {
  file_->stream = &in;
}

TextTable::~TextTable() = default;

void TextTable::refuse(const std::string& sentence) const {
  throw Error(ErrorCode::invalid_argument, sentence,
              path_ + ":" + std::to_string(lines_before() + row_line_));
}

/// The lines of the text before its part. Only a fault needs their number.
std::uint64_t TextTable::lines_before() const {
  if (!has_moved_) {
    return 0;
  }
  std::uint64_t lines = 0;
  const GdalSession session;
  VSILFILE* const file = VSIFOpenL(path_.c_str(), "rb");
  std::string piece(file == nullptr ? 0 : kBufferBytes, '\0');
  bool has_quotes = false, is_behind_cr = false;
  for (std::uint64_t left = first_byte_; left > 0 && file != nullptr;) {
    const std::size_t got =
        VSIFReadL(piece.data(), 1, std::min<std::uint64_t>(left, piece.size()), file);
    if (got == 0) {
      break;
    }
    const std::string_view read(piece.data(), got);
    for (const char c : read) {
      lines += c == '\r' || (c == '\n' && !is_behind_cr) ? 1U : 0U;
      is_behind_cr = c == '\r';
    }
    has_quotes = has_quotes || read.find('"') != std::string_view::npos;
    left -= got;
  }
  if (file != nullptr) {
    VSIFCloseL(file);
  }
  if (has_quotes) {
    throw QuotesInPart(path_);
  }
  return lines;
}

/// Goes on with the first line that begins in the part, and behind the first row of the text, which
/// belongs to the first part.
void TextTable::move_to_part() {
  has_moved_ = true;
  is_pending_ = false;
  begin_ += row_bytes_;
  bytes_read_ += row_bytes_;
  row_bytes_ = 0;
  if (part_.begin > bytes_read_) {
    seek_line(part_.begin);
  }
  first_byte_ = bytes_read_;
  line_ = row_line_ = 0;
}

/// Goes on with the first line that begins at byte `from` or behind it.
void TextTable::seek_line(std::uint64_t from) {
  buffer_.clear();
  begin_ = 0;
  at_end_ = false;
  bytes_read_ = from - 1;  // a line that begins there begins behind the end of another
  const GdalSession session;
  if (VSIFSeekL(file_->handle, bytes_read_, SEEK_SET) != 0) {
    throw Error(ErrorCode::io_error, session.explain("cannot read from the middle"), path_);
  }
  for (;;) {
    begin_ = buffer_.size();
    bytes_read_ += begin_;
    fill();
    if (at_end_) {
      return;
    }
    const char* const last = buffer_.data() + buffer_.size();
    const char* const end = end_of_line(buffer_.data(), last);
    if (end == nullptr) {
      continue;
    }
    begin_ = static_cast<std::size_t>(end - buffer_.data());
    if (*end == '\r' && end + 1 == last) {
      bytes_read_ += begin_;
      fill();  // the LF of a CR LF
      bytes_read_ -= begin_;
    }
    const char* const at = buffer_.data() + begin_;
    const std::size_t passed = bytes_of_line_end(at, buffer_.data() + buffer_.size());
    begin_ += passed;
    bytes_read_ += begin_;
    return;
  }
}

/// Keeps what is left in the buffer and reads on behind it.
void TextTable::fill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kBufferBytes);
  const GdalSession session;
  std::size_t got = 0;
  bool failed = false;
  if (file_->stream != nullptr) {
    file_->stream->read(buffer_.data() + kept, static_cast<std::streamsize>(kBufferBytes));
    got = static_cast<std::size_t>(file_->stream->gcount());
    failed = file_->stream->bad();
  } else {
    // GDAL would write a note of the unpacked size beside the file, in a folder that is not ours.
    const CPLConfigOptionSetter no_notes("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO", false);
    got = VSIFReadL(buffer_.data() + kept, 1, kBufferBytes, file_->handle);
    failed = session.failed() || (file_->on_disk && got == 0 && VSIFEofL(file_->handle) == 0);
  }
  buffer_.resize(kept + got);
  if (failed) {
    const std::uint64_t lines = lines_before() + line_;
    const std::string what = lines == 0 ? "cannot read the first line"
                                        : "cannot read on behind line " + std::to_string(lines);
    throw Error(ErrorCode::io_error,
                session.explain(what + "; the file may be damaged or cut short"), path_);
  }
  at_end_ = got == 0;
}

/// Lengthens the row by one line; false at the end of the text.
bool TextTable::add_line() {
  const std::size_t from = row_bytes_;
  for (;;) {
    const std::size_t left = buffer_.size() - begin_;
    const char* row = buffer_.data() + begin_;
    const char* const last = row + left;
    const char* const end = end_of_line(row + from, last);
    const std::size_t length = end == nullptr ? left : static_cast<std::size_t>(end - row);
    if (length > kLongestRow) {
      row_line_ = from == 0 ? line_ + 1 : row_line_;
      refuse(from == 0 ? "a line is longer than 64 KiB; this does not look like points as text"
                       : "a quoted field that begins in this line does not end within 64 KiB");
    }
    const bool may_be_cut = end == nullptr || (*end == '\r' && end + 1 == last);
    if (may_be_cut && !at_end_) {
      fill();
      continue;
    }
    if (left == from) {
      return false;
    }
    ++line_;
    row_line_ = from == 0 ? line_ : row_line_;
    row_ = {row, length};
    row_bytes_ = length + (end == nullptr ? 0 : bytes_of_line_end(end, last));
    return true;
  }
}

bool TextTable::is_blank(char c) const noexcept {
  return is_blank_character(c) && (c != '\t' || separator_ != '\t');
}

bool TextTable::is_separator(char c) const noexcept {
  return separator_ == ' ' ? is_blank_character(c) : c == separator_;
}

std::string_view TextTable::without_blanks(std::string_view text) const noexcept {
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

void TextTable::split_unquoted(std::string_view row) {
  if (separator_ != ' ') {
    for (;;) {
      const std::size_t end = row.find(separator_);
      fields_.push_back(without_blanks(row.substr(0, end)));
      if (end == std::string_view::npos) {
        return;
      }
      row.remove_prefix(end + 1);
    }
  }
  for (std::size_t i = 0; i < row.size();) {
    std::size_t end = i;
    while (end < row.size() && !is_separator(row[end])) {
      ++end;
    }
    if (end > i) {
      fields_.push_back(row.substr(i, end - i));
    }
    i = end + 1;
  }
}

/// False where a quoted field does not end in the row.
bool TextTable::split_quoted(std::string_view row) {
  unquoted_.clear();
  unquoted_.reserve(row.size());  // fields_ holds views into it
  for (std::size_t i = 0;; ++i) {
    while (i < row.size() && is_blank(row[i])) {
      ++i;
    }
    if (i == row.size() && separator_ == ' ') {
      return true;
    }
    std::size_t end = i;
    if (i < row.size() && row[i] == '"') {
      end = end_of_quoted(row, i);
      if (end == std::string_view::npos) {
        return false;
      }
      const std::size_t begin = unquoted_.size();
      for (std::size_t c = i + 1; c + 1 < end; c += row[c] == '"' ? 2 : 1) {
        unquoted_ += row[c];
      }
      fields_.push_back(std::string_view(unquoted_).substr(begin));
      while (end < row.size() && is_blank(row[end]) && !is_separator(row[end])) {
        ++end;
      }
      if (end < row.size() && !is_separator(row[end])) {
        refuse("text follows the quotes around field " + std::to_string(fields_.size()) +
               "; a quote within quotes is written twice");
      }
    } else {
      while (end < row.size() && !is_separator(row[end])) {
        ++end;
      }
      fields_.push_back(without_blanks(row.substr(i, end - i)));
    }
    if (end == row.size()) {
      return true;
    }
    i = end;
  }
}

/// Splits the row into fields; false where a quoted field does not end in it.
bool TextTable::split() {
  if (!begun_) {
    separator_ = separator_of(row_);
  }
  fields_.clear();
  if (row_.find('"') != std::string_view::npos) {
    if (begun_ && !part_.is_whole()) {
      throw QuotesInPart(path_);
    }
    return split_quoted(row_);
  }
  split_unquoted(row_);
  return true;
}

/// Reads the next line that is neither empty nor a comment, with those that its quotes go on in.
bool TextTable::next_row() {
  for (;;) {
    begin_ += row_bytes_;
    bytes_read_ += file_->packed ? 0 : row_bytes_;
    row_bytes_ = 0;
    if ((begun_ && bytes_read_ >= part_.end) || !add_line()) {
      return false;
    }
    const bool is_first = line_ == 1 && !has_moved_;
    if (!begun_) {
      if (const auto fault = fault_of_encoding(row_, is_first)) {
        refuse(*fault);
      }
    }
    const std::size_t mark = is_first ? bytes_of_byte_order_mark(row_) : 0;
    row_.remove_prefix(mark);
    const std::string_view text = trimmed(row_);
    if (text.empty() || (!begun_ && tells_separator(text))) {
      continue;
    }
    if (comment_mark(text) > 0) {
      if (!begun_) {
        note_comment(text);
      }
      continue;
    }
    while (!split()) {
      if (!add_line()) {
        refuse("a quoted field that begins in this line does not end");
      }
      row_.remove_prefix(mark);
    }
    return true;
  }
}

/// Keeps a comment that stands before the first row.
void TextTable::note_comment(std::string_view text) {
  declared_.note(text.substr(comment_mark(text)));
  if (comments_.size() == kMostComments) {
    comments_.erase(comments_.begin());
  }
  constexpr std::size_t kLongest = 4096;
  comments_.emplace_back(text.substr(0, kLongest));
}

/// Looks at the first row: separator, number of fields, header.
void TextTable::begin() {
  is_pending_ = next_row();
  begun_ = true;
  field_count_ = fields_.size();
  for (const std::string_view field : fields_) {
    header_.emplace_back(trimmed(field));
  }
  if (is_pending_ && is_header(header_)) {
    is_pending_ = false;
    if (separator_ == ' ') {
      join_units(header_);
      field_count_ = header_.size();
    }
  } else {
    header_ = header_in_comments(comments_, field_count_).value_or(std::vector<std::string>());
    is_told_by_comment_ = !header_.empty();
  }
  comments_.clear();
}

const std::vector<std::string>& TextTable::header() {
  if (!begun_) {
    begin();
  }
  return header_;
}

/// True where the row has more fields than the first one, since the text of its last column has the
/// separator. A number there is more likely a coordinate whose decimal comma divides it.
bool TextTable::goes_on_in_last() const {
  return may_last_go_on_ && fields_.size() > field_count_ &&
         !begins_as_number(fields_[field_count_ - 1]);
}

bool TextTable::next() {
  if (!begun_) {
    begin();
  }
  if (part_.begin > 0 && !has_moved_) {
    move_to_part();
  } else if (std::exchange(is_pending_, false)) {
    return true;
  }
  if (!next_row()) {
    return false;
  }
  if (!may_misfit_ && is_misfit()) {
    refuse(misfit());
  }
  return true;
}

bool TextTable::is_misfit() const { return fields_.size() != field_count_ && !goes_on_in_last(); }

std::string TextTable::misfit() const {
  if (!is_misfit()) {
    return {};
  }
  const std::string counts = "there are " + std::to_string(fields_.size()) +
                             " fields where the first line has " + std::to_string(field_count_);
  if (separator_ == ' ') {
    return counts + ", which blanks separate; separate the fields of all lines alike";
  }
  if (fields_.size() == 1) {
    const char* const marks = separator_ == '\t'  ? "tabs"
                              : separator_ == ';' ? "semicolons"
                                                  : "commas";
    return counts + ": " + marks +
           " separate the fields of the first line, so those of all, and this line has none; "
           "separate the fields of all lines alike";
  }
  return counts + (separator_ == ',' && fields_.size() > field_count_
                       ? "; numbers have a decimal point, no comma"
                       : "");
}

std::string shown_field(std::string_view field) {
  std::string text(field.substr(0, 40));
  for (char& c : text) {
    c = static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return "'" + text + (field.size() > 40 ? "...'" : "'");
}

std::string why_no_number(std::string_view field) {
  Decimal ignored;
  if (field.empty()) {
    return "is empty; give it a number, or leave the line out";
  }
  std::string with_point(field);
  if (const std::size_t comma = with_point.find(','); comma != std::string::npos) {
    with_point[comma] = '.';
    if (parse_number(with_point, ignored) != NumberKind::kNoNumber) {
      return "has a decimal comma; write it with a point, " + with_point;
    }
  }
  if (has_two_numbers(field)) {
    return "holds two numbers; a comma or a semicolon in the first line separates the fields of "
           "all "
           "lines, and numbers have a decimal point";
  }
  return "is no number; numbers are written with a decimal point, as in -12.5";
}

}  // namespace ptin
