// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/text_samples.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>

#include <cpl_conv.h>
#include <cpl_vsi.h>

#include "engine/construct/read/input_kind.h"
#include "engine/crs/height_unit.h"
#include "engine/error.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr const char* kBlanks = " \t\r\n\f\v\x1a";

/// The names of the columns x, y and z, in the order in which they are looked for.
const std::array<std::vector<std::string>, 3>& column_names() {
  static const std::array<std::vector<std::string>, 3> names = {
      {{"x", "easting", "eastings", "east", "e", "longitude", "lon", "long", "lng", "point_x",
        "x_coord", "xcoord"},
       {"y", "northing", "northings", "north", "n", "latitude", "lat", "point_y", "y_coord",
        "ycoord"},
       {"z", "height", "h", "elevation", "elev", "ele", "altitude", "alt", "point_z", "z_coord",
        "zcoord"}}};
  return names;
}

std::string_view trimmed(std::string_view text, const char* blanks = kBlanks) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

bool is_any_of(char c, std::string_view all) { return all.find(c) != std::string_view::npos; }

/// What may stand around a field without being of it.
const char* blanks_beside(char separator) { return separator == '\t' ? " \r\n\f\v\x1a" : kBlanks; }

/// For each character whether it is outside of quotes; nothing where the text ends within them.
/// Quotes open at the begin of a field alone. Before the separator is known ('\0') a field begins
/// behind anything that may be one.
std::vector<bool> outside_of_quotes(std::string_view text, char separator) {
  std::vector<bool> outside(text.size() + 1, true);
  bool within = false, at_begin = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (within) {
      outside[i] = false;
      within = c != '"';
      if (!within && i + 1 < text.size() && text[i + 1] == '"') {  // two quotes are one
        outside[++i] = false;
        within = true;
      }
    } else if (c == '"' && at_begin) {
      outside[i] = false;
      within = true;
      at_begin = false;
    } else {
      const bool separates = separator == '\0'  ? is_any_of(c, ";, \t\r")
                             : separator == ' ' ? is_any_of(c, kBlanks)
                                                : c == separator;
      at_begin = separates || (at_begin && is_any_of(c, blanks_beside(separator)));
    }
  }
  return within ? std::vector<bool>() : outside;
}

std::string unquoted(std::string_view field) {
  if (field.size() < 2 || field.front() != '"' || field.back() != '"') return std::string(field);
  std::string text;
  for (std::size_t i = 1; i + 1 < field.size(); ++i) {
    text += field[i];
    i += field[i] == '"' ? 1 : 0;
  }
  return text;
}

std::string as_name(const std::string& field) { return lower_case(std::string(trimmed(field))); }

/// A name in small letters without the unit behind it: "z [ft]", "z(ft)" and "z_ft" are z.
std::string without_unit(const std::string& field) {
  std::string name = as_name(field);
  if (!name.empty() && (name.back() == ')' || name.back() == ']')) {
    const std::size_t open = name.rfind(name.back() == ')' ? '(' : '[');
    if (open != std::string::npos && open > 0) return std::string(trimmed(name.substr(0, open)));
  }
  const std::size_t line = name.rfind('_');
  if (line == std::string::npos || line == 0) return name;
  const std::string unit = name.substr(line + 1);
  const bool is_degree =
      unit == "deg" || unit == "degree" || unit == "degrees" || unit == "dd" || unit == "\u00b0";
  return is_degree || metres_in(height_unit_named(unit)) ? name.substr(0, line) : name;
}

/// The column of an axis; names.size() where none is it. Names without a unit come first.
std::size_t column_of(const std::vector<std::string>& names, std::size_t axis) {
  for (const bool with_unit : {false, true}) {
    for (const std::string& known : column_names()[axis]) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        if ((with_unit ? without_unit(names[i]) : as_name(names[i])) == known) return i;
      }
    }
  }
  return names.size();
}

bool is_coordinate(const std::string& name) {
  for (const std::size_t axis : {0U, 1U, 2U}) {
    if (column_of({name}, axis) == 0) return true;
  }
  return false;
}

/// The text of a comment without its mark; none where the line is no comment.
std::optional<std::string_view> text_of_comment(std::string_view line) {
  if (line.starts_with("//"))
    return line.substr(std::min(line.find_first_not_of('/'), line.size()));
  if (line.empty() || !is_any_of(line.front(), "#%!>")) return std::nullopt;
  return line.substr(std::min(line.find_first_not_of("#%!>"), line.size()));
}

/// Units in brackets that stand behind their names.
void join_units(std::vector<std::string>& names) {
  const auto is_unit = [](const std::string& s) {
    return s.size() > 2 &&
           ((s.front() == '(' && s.back() == ')') || (s.front() == '[' && s.back() == ']'));
  };
  for (std::size_t i = 1; i < names.size();) {
    if (is_unit(names[i]) && !is_unit(names[i - 1])) {
      names[i - 1] += " " + names[i];
      names.erase(names.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
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

bool begins_as_number(const std::string& field) {
  const std::size_t first = field.find_first_not_of("'+-.");
  return number_of(field).has_value() ||
         (first != std::string::npos && is_any_of(field[first], "0123456789"));
}

/// True when two words between two tabs begin as numbers: then tabs separate as blanks do.
bool has_numbers_between_tabs(const std::string& text) {
  std::istringstream columns(text);
  for (std::string column; std::getline(columns, column, '\t');) {
    std::istringstream words(column);
    if (std::count_if(std::istream_iterator<std::string>(words), {}, begins_as_number) > 1)
      return true;
  }
  return false;
}

char separator_of(const std::string& text) {
  const std::vector<bool> outside = outside_of_quotes(text, '\0');
  for (const char candidate : {';', ',', '\t'}) {
    if (candidate == '\t' && has_numbers_between_tabs(text)) break;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (outside[i] && text[i] == candidate) return candidate;
    }
  }
  return ' ';
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

TextSamples::TextSamples(std::string path, const std::vector<std::string>& columns,
                         bool is_nodata_told)
    : path_(std::move(path)),
      file_(std::make_unique<File>()),
      given_(columns),
      is_nodata_told_(is_nodata_told) {
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

bool TextSamples::next_line(std::string_view& line) {
  std::size_t end = buffer_.find_first_of("\r\n", begin_);
  // A CR at the end of what is at hand may be the first half of a line end.
  while (!at_end_ && (end == std::string::npos ? buffer_.size() - begin_ <= kLongestLine
                                               : end + 1 == buffer_.size())) {
    fill();
    end = buffer_.find_first_of("\r\n", begin_);
  }
  const bool is_pair = end != std::string::npos && buffer_.compare(end, 2, "\r\n") == 0;
  if (end == std::string::npos) end = buffer_.size();
  if (begin_ == buffer_.size()) return false;
  ++number_;
  if (end - begin_ > kLongestLine)
    refuse("a line is longer than 64 KiB; this does not look like points as text");
  line = std::string_view(buffer_).substr(begin_, end - begin_);
  begin_ = std::min(end + (is_pair ? 2 : 1), buffer_.size());
  return true;
}

bool TextSamples::next_text(std::string& text) {
  std::string_view line;
  for (;;) {
    if (!next_line(line)) return false;
    if (number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    if (trimmed(line).empty()) continue;
    const std::string_view start = trimmed(line).substr(0, 4);  // Excel's "sep=;"
    const bool is_of_excel = start == "sep=" || start == "SEP=" || start == "Sep=";
    if (field_count_ == 0 && is_of_excel && trimmed(line).size() <= 5) continue;
    const std::optional<std::string_view> comment = text_of_comment(trimmed(line));
    if (!comment) break;
    if (field_count_ != 0) continue;
    comments_.emplace_back(comment->substr(0, 4096));
    declared_.note(*comment);
  }
  first_ = number_;
  text = line;
  if (text.find('"') == std::string::npos) return true;
  while (outside_of_quotes(text, separator_).empty()) {
    if (text.size() > kLongestLine || !next_line(line)) {
      number_ = first_;
      refuse("the quotes of a field that begins in this line do not end");
    }
    text.append(1, '\n').append(line);
  }
  return true;
}

void TextSamples::split(std::string_view text) {
  const bool has_quotes = text.find('"') != std::string_view::npos;
  const std::vector<bool> outside =
      has_quotes ? outside_of_quotes(text, separator_) : std::vector<bool>();
  const bool by_blanks = separator_ == ' ';
  const auto separates = [&](std::size_t i) {
    return (!has_quotes || outside[i]) &&
           (by_blanks ? is_any_of(text[i], kBlanks) : text[i] == separator_);
  };
  fields_.clear();
  for (std::size_t begin = 0; begin <= text.size();) {
    std::size_t end = begin;
    while (end < text.size() && !separates(end)) ++end;
    if (end > begin || !by_blanks) {
      fields_.push_back(
          unquoted(trimmed(text.substr(begin, end - begin), blanks_beside(separator_))));
    }
    begin = end + 1;
  }
}

bool TextSamples::begin(std::string_view text) {
  split(text);
  field_count_ = fields_.size();
  const bool is_header =
      std::none_of(fields_.begin(), fields_.end(), begins_as_number) ||
      (column_of(fields_, 0) < field_count_ && column_of(fields_, 1) < field_count_);
  std::vector<std::string> names = is_header ? fields_ : names_in_comments();
  if (is_header && separator_ == ' ') {
    join_units(names);
    field_count_ = names.size();
  }
  if (!given_.empty()) names = given_;
  if (!names.empty()) {
    choose_columns(names);
  } else if (field_count_ < 3) {
    refuse("the first line has fewer than three fields, so no x, y and z");
  }
  may_go_on_ = names.size() >= field_count_ &&
               std::find(columns_.begin(), columns_.end(), field_count_ - 1) == columns_.end();
  return is_header;
}

/// True where a comment names x and y, one beside the other or with coordinates alone between them,
/// and names no more columns than there are; or the coordinates of all columns, and then a remark.
bool TextSamples::names_columns(std::string_view comment, std::vector<std::string>& names) const {
  const std::string text(trimmed(comment));
  const char separator = separator_of(text);
  names.clear();
  std::string name;
  const auto end_name = [&] {
    std::string_view bare = trimmed(name);
    if (bare.size() > 1 && bare.front() == '"' && bare.back() == '"')
      bare = trimmed(bare.substr(1, bare.size() - 2));
    if (!bare.empty() || separator != ' ') names.emplace_back(bare);
    name.clear();
  };
  for (const char c : text) {
    if (separator == ' ' ? is_any_of(c, kBlanks) : c == separator) {
      end_name();
    } else {
      name += c;
    }
  }
  end_name();
  if (separator == ' ') join_units(names);
  if (names.size() > field_count_) {
    names.resize(field_count_);
    if (!std::all_of(names.begin(), names.end(), is_coordinate)) return false;
  }
  const std::size_t x = column_of(names, 0), y = column_of(names, 1);
  if (x == names.size() || y == names.size()) return false;
  for (std::size_t i = std::min(x, y); i < std::max(x, y); ++i) {
    if (!is_coordinate(names[i])) return false;
  }
  return true;
}

/// The names of the columns in the last comment that tells them; nothing where none does.
std::vector<std::string> TextSamples::names_in_comments() const {
  std::vector<std::string> names;
  for (auto comment = comments_.rbegin(); comment != comments_.rend(); ++comment) {
    const std::size_t colon = comment->find(':');
    if (names_columns(*comment, names) ||
        (colon != std::string::npos && names_columns(comment->substr(colon + 1), names))) {
      names.resize(field_count_);
      return names;
    }
  }
  return {};
}

void TextSamples::choose_columns(const std::vector<std::string>& names) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns_[axis] = column_of(names, axis);
    if (columns_[axis] >= std::min(field_count_, names.size())) {
      refuse(std::string("neither a raster that GDAL reads nor points as text: the first "
                         "line, or --columns of the build, names no column for ") +
             "xyz"[axis]);
    }
  }
}

void TextSamples::read_numbers(Line& line) const {
  const bool goes_on =
      may_go_on_ && fields_.size() > field_count_ && !begins_as_number(fields_[field_count_ - 1]);
  if (fields_.size() != field_count_ && !goes_on) {
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
  std::string text;
  while (next_text(text)) {
    if (field_count_ == 0) {
      separator_ = separator_of(text);
      if (begin(text)) continue;
    } else {
      split(text);
    }
    line = {first_, {}, {}};
    read_numbers(line);
    const std::optional<double> nodata = is_nodata_told_ ? std::nullopt : declared_.nodata();
    if (!nodata || !line.misfit.empty() || line.point[2] != *nodata) return true;
  }
  return false;
}

}  // namespace ptin::tools
