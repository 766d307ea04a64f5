// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/text_samples.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "engine/construct/read/input_kind.h"
#include "engine/error.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr const char* kBlanks = " \t\r";

/// The names of the columns x, y and z, in the order in which they are looked for.
const std::array<std::vector<std::string>, 3>& column_names() {
  static const std::array<std::vector<std::string>, 3> names = {
      {{"x", "easting", "east", "e", "longitude", "lon", "long", "point_x"},
       {"y", "northing", "north", "n", "latitude", "lat", "point_y"},
       {"z", "height", "h", "elevation", "elev", "altitude", "alt", "point_z"}}};
  return names;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// The number in a field; none where the field is no number. NaN and infinities are numbers.
std::optional<double> number_of(std::string_view field) {
  if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
  double value = 0.0;
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size() || status == std::errc::invalid_argument)
    return std::nullopt;
  if (status != std::errc()) {  // Too large, or too near to zero for a double.
    const bool is_tiny =
        field.find("e-") != std::string_view::npos || field.find("E-") != std::string_view::npos;
    return is_tiny ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return value;
}

}  // namespace

struct TextSamples::File {
  VSILFILE* handle = nullptr;
  File() = default;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (handle != nullptr) VSIFCloseL(handle);
  }
};

TextSamples::TextSamples(std::string path)
    : path_(std::move(path)), file_(std::make_unique<File>()) {
  file_->handle = VSIFOpenL(((is_packed(path_) ? "/vsigzip/" : "") + path_).c_str(), "rb");
  if (file_->handle == nullptr) throw Error(ErrorCode::io_error, "cannot be read", path_);
}

TextSamples::~TextSamples() = default;

void TextSamples::refuse(const std::string& sentence) const {
  throw Error(ErrorCode::invalid_argument, sentence, path_ + ":" + std::to_string(number_));
}

/// Keeps what is left in the buffer and reads on behind it.
void TextSamples::fill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + kPieceBytes);
  // GDAL must not write notes about the unpacked size beside a file that is not ours.
  const CPLConfigOptionSetter no_notes("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO", false);
  CPLErrorReset();
  const std::size_t got = VSIFReadL(buffer_.data() + kept, 1, kPieceBytes, file_->handle);
  buffer_.resize(kept + got);
  if (CPLGetLastErrorType() >= CE_Failure) {
    throw Error(ErrorCode::io_error,
                "cannot be read on behind line " + std::to_string(number_) +
                    "; the file may be damaged or cut short",
                path_);
  }
  at_end_ = got == 0;
  if (at_end_ && !is_packed(path_) && VSIFEofL(file_->handle) == 0) {  // GDAL tells nothing
    throw Error(ErrorCode::io_error,
                "cannot read on behind line " + std::to_string(number_) + ": the system refuses",
                path_);
  }
}

bool TextSamples::next_text(std::string_view& text) {
  std::size_t end = buffer_.find('\n', begin_);
  while (end == std::string::npos && !at_end_ && buffer_.size() - begin_ <= kLongestLine) {
    fill();
    end = buffer_.find('\n', begin_);
  }
  if (end == std::string::npos) end = buffer_.size();
  if (begin_ == buffer_.size()) return false;
  ++number_;
  if (end - begin_ > kLongestLine)
    refuse("a line is longer than 64 KiB; this does not look like points as text");
  text = std::string_view(buffer_).substr(begin_, end - begin_);
  begin_ = std::min(end + 1, buffer_.size());
  return true;
}

void TextSamples::split(std::string_view text) {
  fields_.clear();
  const bool by_blanks = separator_ == ' ';
  while (by_blanks ? !text.empty() : true) {
    const std::size_t end = by_blanks ? text.find_first_of(kBlanks) : text.find(separator_);
    fields_.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
    if (by_blanks) text = trimmed(text);
  }
}

bool TextSamples::begin(std::string_view text) {
  separator_ = text.find(';') != std::string_view::npos   ? ';'
               : text.find(',') != std::string_view::npos ? ','
                                                          : ' ';
  split(text);
  field_count_ = fields_.size();
  if (!number_of(fields_[0])) {
    choose_columns();
    return true;
  }
  if (field_count_ < 3) refuse("the first line has fewer than three fields, so no x, y and z");
  return false;
}

void TextSamples::choose_columns() {
  std::vector<std::string> header;
  for (std::string_view field : fields_) {
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
      field = trimmed(field.substr(1, field.size() - 2));
    header.push_back(lower_case(std::string(field)));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns_[axis] = header.size();
    for (const std::string& name : column_names()[axis]) {
      const auto found = std::find(header.begin(), header.end(), name);
      if (found == header.end()) continue;
      columns_[axis] = static_cast<std::size_t>(found - header.begin());
      break;
    }
    if (columns_[axis] == header.size()) {
      refuse(std::string("neither a raster that GDAL reads nor points as text: the first line "
                         "holds no number first and names no column for ") +
             "xyz"[axis]);
    }
  }
}

void TextSamples::read_numbers(Line& line) const {
  if (fields_.size() != field_count_) {
    line.misfit = "this line has " + std::to_string(fields_.size()) + " fields, the first one " +
                  std::to_string(field_count_);
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = number_of(fields_[columns_[axis]]);
    if (!value || !std::isfinite(*value)) {
      line.misfit = std::string("the ") + "xyz"[axis] + " of this line is no finite number";
      return;
    }
    line.point[axis] = *value;
  }
}

bool TextSamples::next(Line& line) {
  std::string_view text;
  while (next_text(text)) {
    if (number_ == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    text = trimmed(text);
    if (text.empty() || text.front() == '#') continue;
    if (separator_ == '\0') {
      if (begin(text)) continue;
    } else {
      split(text);
    }
    line = {number_, {}, {}};
    read_numbers(line);
    return true;
  }
  return false;
}

}  // namespace ptin::tools
