// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/read/xyz_reader.h"

#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/column_names.h"
#include "engine/construct/read/input_kind.h"
#include "engine/error.h"

namespace ptin {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{1} << 16;

constexpr std::array<const char*, 3> kRoles = {"x", "y", "z"};
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_space(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

/// At most 40 characters of a field, with others than printable ones replaced, for messages.
std::string shown(std::string_view field) {
  std::string text(field.substr(0, 40));
  for (char& c : text) {
    c = static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  }
  return "'" + text + (field.size() > 40 ? "...'" : "'");
}

}  // namespace

struct XyzReader::File {
  VSILFILE* handle = nullptr;
  bool packed = false;
  ~File() {
    if (handle != nullptr) {
      const GdalSession session;
      VSIFCloseL(handle);
    }
  }
};

XyzReader::XyzReader(std::string path) : path_(std::move(path)), file_(std::make_unique<File>()) {
  const GdalSession session;
  file_->packed = is_packed(path_);
  errno = 0;
  file_->handle = VSIFOpenL(((file_->packed ? "/vsigzip/" : "") + path_).c_str(), "rb");
  if (file_->handle == nullptr) {
    VSIStatBufL status;
    if (VSIStatL(path_.c_str(), &status) != 0) {
      throw Error(ErrorCode::not_found, "there is no such file of points", path_);
    }
    throw errno != 0 ? system_error(errno, "cannot open", path_)
                     : Error(ErrorCode::io_error, session.explain("cannot open"), path_);
  }
  buffer_.reserve(kBufferBytes + kLongestLine);
}

XyzReader::XyzReader(std::string name, std::string text)
    : path_(std::move(name)),
      file_(std::make_unique<File>()),
      buffer_(std::move(text)),
      at_end_(true) {}

XyzReader::~XyzReader() = default;

void XyzReader::refuse(const std::string& sentence) const {
  throw Error(ErrorCode::invalid_argument, sentence, path_ + ":" + std::to_string(line_));
}

/// Keeps what is left in the buffer and reads on behind it.
void XyzReader::fill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kBufferBytes);
  const GdalSession session;
  // GDAL would write a note of the unpacked size beside the file, in a folder that is not ours.
  const CPLConfigOptionSetter no_notes("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO", false);
  const std::size_t got = VSIFReadL(buffer_.data() + kept, 1, kBufferBytes, file_->handle);
  buffer_.resize(kept + got);
  if (session.failed()) {
    throw Error(ErrorCode::io_error,
                session.explain("cannot read on behind line " + std::to_string(line_) +
                                "; the file may be damaged or cut short"),
                path_);
  }
  at_end_ = got == 0;
  if (at_end_ && !file_->packed && VSIFEofL(file_->handle) == 0) {  // GDAL raises no failure
    throw Error(ErrorCode::io_error,
                "cannot read on behind line " + std::to_string(line_) + ": the system refuses",
                path_);
  }
}

bool XyzReader::next_line(std::string_view& line) {
  for (;;) {
    const std::size_t left = buffer_.size() - begin_;
    const char* from = buffer_.data() + begin_;
    const auto* end = static_cast<const char*>(left == 0 ? nullptr : std::memchr(from, '\n', left));
    const std::size_t length = end == nullptr ? left : static_cast<std::size_t>(end - from);
    if (length > kLongestLine) {
      ++line_;
      refuse("a line is longer than 64 KiB; this does not look like points as text");
    }
    if (end == nullptr && !at_end_) {
      fill();
      continue;
    }
    if (left == 0) {
      return false;
    }
    ++line_;
    line = {from, length};
    begin_ += length + (end == nullptr ? 0 : 1);
    bytes_read_ += file_->packed ? 0 : length + 1;
    return true;
  }
}

void XyzReader::split(std::string_view line) {
  fields_.clear();
  if (separator_ != ' ') {
    for (;;) {
      const std::size_t end = line.find(separator_);
      fields_.push_back(trimmed(line.substr(0, end)));
      if (end == std::string_view::npos) {
        return;
      }
      line.remove_prefix(end + 1);
    }
  }
  for (std::size_t i = 0; i < line.size();) {
    std::size_t end = i;
    while (end < line.size() && !is_space(line[end])) {
      ++end;
    }
    if (end > i) {
      fields_.push_back(line.substr(i, end - i));
    }
    i = end + 1;
  }
}

/// Looks at the first line: separator, number of fields, header.
void XyzReader::begin(std::string_view line) {
  separator_ = line.find(';') != std::string_view::npos   ? ';'
               : line.find(',') != std::string_view::npos ? ','
                                                          : ' ';
  split(line);
  field_count_ = fields_.size();
  Decimal ignored;
  header_ = parse_number(fields_[0], ignored) == NumberKind::kNoNumber;
  if (header_) {
    find_columns();
  } else if (field_count_ < 3) {
    refuse("there are " + std::to_string(field_count_) +
           " fields in the first line, where x, y and z are expected");
  }
}

void XyzReader::find_columns() {
  columns_ = {find_column(fields_, Coordinate::kX), find_column(fields_, Coordinate::kY),
              find_column(fields_, Coordinate::kZ)};
  for (std::size_t role = 0; role < 3; ++role) {
    if (columns_[role] == fields_.size()) {
      refuse(std::string("the first line is taken for a header, since ") + shown(fields_[0]) +
             " is no number, but names no column for " + kRoles[role] +
             "; columns are named x, y, z or easting, northing, height or lon, lat, elevation");
    }
  }
}

Decimal XyzReader::number(int role) const {
  const std::string_view field = fields_[columns_[static_cast<std::size_t>(role)]];
  const std::string name = kRoles[static_cast<std::size_t>(role)];
  Decimal value;
  switch (parse_number(field, value)) {
    case NumberKind::kNumber:
      return value;
    case NumberKind::kNotANumber:
      refuse("the " + name + " of this point is NaN; leave points without a height out");
    case NumberKind::kInfinite:
      refuse("the " + name + " of this point is infinite");
    case NumberKind::kTooLarge:
      refuse("the " + name + " of this point, " + shown(field) + ", is 10^18 or more");
    case NumberKind::kNoNumber:
      break;
  }
  refuse("the " + name + " of this point, " + shown(field) +
         ", is no number; numbers are written with a decimal point, as in -12.5");
}

bool XyzReader::next(XyzPoint& point) {
  std::string_view line;
  while (next_line(line)) {
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) {  // a byte order mark
      line.remove_prefix(3);
    }
    line = trimmed(line);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (separator_ == '\0') {
      begin(line);
      if (header_) {
        continue;
      }
    } else {
      split(line);
    }
    if (fields_.size() != field_count_) {
      refuse("there are " + std::to_string(fields_.size()) + " fields where the first line has " +
             std::to_string(field_count_));
    }
    point = {number(0), number(1), number(2)};
    return true;
  }
  return false;
}

}  // namespace ptin
