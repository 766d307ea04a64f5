// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/number_rows.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include <ogr_geometry.h>

#include "engine/construct/read/column_names.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"
#include "tools/output/file_name.h"
#include "tools/region/vector_input.h"

namespace ptin::tools {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// Splits a line into fields. Blanks only set fields apart. Two commas, two semicolons or, in a
/// line without either, two tabs in a row have an empty field between them: a number that is
/// missing must not shift the others.
void split_fields(std::string_view line, std::vector<std::string_view>& fields) {
  const bool listed = line.find_first_of(",;") != std::string_view::npos;
  const std::string_view separators = listed ? ",;" : "\t";
  const std::string_view blanks = listed ? " \t\r" : " \r";
  const auto skip_blanks = [&] {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  };
  fields.clear();
  if (line.find_first_not_of(" \t\r") == std::string_view::npos) return;
  skip_blanks();
  for (bool more = true; more;) {
    std::size_t length = 0;
    while (length < line.size() && separators.find(line[length]) == std::string_view::npos &&
           blanks.find(line[length]) == std::string_view::npos) {
      ++length;
    }
    fields.push_back(line.substr(0, length));
    line.remove_prefix(length);
    skip_blanks();
    more = !line.empty();
    if (more && separators.find(line.front()) != std::string_view::npos) {
      line.remove_prefix(1);
      skip_blanks();
    }
  }
}

std::optional<double> number_of(std::string_view field) {
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
    field = field.substr(1, field.size() - 2);
  }
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (fault != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

/// True for a number, and for a field that was meant as one: quoted, with a unit or a decimal
/// comma.
bool looks_like_number(std::string_view field) {
  const std::size_t begin = field.find_first_not_of("\"'+-.");
  return number_of(field) ||
         (begin != std::string_view::npos && field[begin] >= '0' && field[begin] <= '9');
}

[[noreturn]] void throw_bad_line(std::size_t number, const std::string& what,
                                 std::span<const std::size_t> columns, const std::string& name) {
  throw Error(ErrorCode::invalid_argument,
              "line " + std::to_string(number) + " " + what + ", expected " +
                  std::to_string(columns.size()) + " numbers separated by commas or spaces",
              name);
}

/// Chooses columns by a header's names.
using ByHeader =
    std::function<void(std::span<const std::string_view> names, std::vector<std::size_t>& columns)>;

/// Chooses the columns of x and y where the header names both.
void choose_x_and_y(std::span<const std::string_view> names, std::vector<std::size_t>& columns) {
  const std::size_t x = find_column(names, Coordinate::kX);
  const std::size_t y = find_column(names, Coordinate::kY);
  if (x == names.size() || y == names.size()) {
    throw Error(ErrorCode::invalid_argument,
                std::string("the header names no column for ") +
                    (x != names.size()   ? "y"
                     : y != names.size() ? "x"
                                         : "x and none for y") +
                    "; columns are named x, y or easting, northing or lon, lat or point_x, "
                    "point_y; without a header x and y come first");
  }
  columns = {x, y};
}

/// Appends the numbers of the fields `columns` to `rows`, in the order of `columns`.
void append_row(std::span<const std::string_view> fields, std::span<const std::size_t> columns,
                std::size_t line, const std::string& name, std::vector<double>& rows) {
  for (const std::size_t i : columns) {
    if (i >= fields.size()) {
      throw_bad_line(line, "has only " + std::to_string(fields.size()) + " fields", columns, name);
    }
    const std::string place = "field " + std::to_string(i + 1);
    if (fields[i].empty()) throw_bad_line(line, "has nothing in " + place, columns, name);
    const std::optional<double> value = number_of(fields[i]);
    if (!value) throw_bad_line(line, "has no number in " + place, columns, name);
    rows.push_back(*value);
  }
}

/// @param columns  The columns where there is no header, or `by_header` finds no names in it.
std::vector<double> rows_of(std::istream& in, const std::string& name,
                            std::vector<std::size_t> columns, const ByHeader& by_header) {
  std::vector<double> rows;
  std::vector<std::string_view> fields;
  std::string line;
  bool is_first = true;  // Blank lines and comments do not count.
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    split_fields(line, fields);
    if (fields.empty() || fields.front().starts_with('#')) continue;
    const bool header = is_first && std::none_of(fields.begin(), fields.end(), looks_like_number);
    is_first = false;
    if (header) {
      by_header(fields, columns);
    } else {
      append_row(fields, columns, number, name, rows);
    }
  }
  if (in.bad()) throw Error(ErrorCode::io_error, "cannot be read to its end", name);
  return rows;
}

void require_file(const std::string& path) {
  if (!is_there(path)) throw Error(ErrorCode::not_found, "no such file", path);
}

bool is_text(const std::string& path) {
  const std::string extension = lower_extension(path);
  return path == "-" || extension == ".csv" || extension == ".tsv" || extension == ".txt" ||
         extension == ".xyz" || extension.empty();
}

void add_lines(const OGRGeometry& geometry, std::vector<std::vector<MapPoint>>& lines) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbLineString) {
    const OGRLineString* line = geometry.toLineString();
    std::vector<MapPoint> points;
    for (int i = 0; i < line->getNumPoints(); ++i) points.push_back({line->getX(i), line->getY(i)});
    if (!points.empty()) lines.push_back(std::move(points));
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection) != 0) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) add_lines(*part, lines);
  } else if (OGR_GT_IsSubClassOf(type, wkbCurve) != 0) {
    const std::unique_ptr<OGRGeometry> straight(geometry.getLinearGeometry());
    if (straight) add_lines(*straight, lines);
  }
}

std::vector<double> rows_of_file(const std::string& path, const std::vector<std::size_t>& columns,
                                 const ByHeader& by_header) {
  if (path == "-") return rows_of(std::cin, "standard input", columns, by_header);
  require_file(path);
  std::error_code ignored;  // Opening tells what is wrong.
  if (std::filesystem::is_directory(path, ignored)) {
    throw Error(ErrorCode::invalid_argument, "is a folder; name a text file with numbers", path);
  }
  errno = 0;
  std::ifstream in(path);
  if (!in) throw system_error(errno, "cannot open", path);
  return rows_of(in, path, columns, by_header);
}

}  // namespace

std::vector<double> read_rows(const std::string& path, std::size_t columns) {
  std::vector<std::size_t> first(columns);
  std::iota(first.begin(), first.end(), std::size_t{0});
  return rows_of_file(path, first, [](const auto&, const auto&) {});
}

std::vector<MapPoint> read_points(const std::string& path, const std::string& crs_wkt) {
  std::vector<MapPoint> points;
  if (is_text(path)) {
    const std::vector<double> rows = rows_of_file(path, {0, 1}, choose_x_and_y);
    for (std::size_t i = 0; i + 1 < rows.size(); i += 2) points.push_back({rows[i], rows[i + 1]});
    return points;
  }
  for_each_geometry(path, crs_wkt, [&](long long id, const OGRGeometry* geometry) {
    if (geometry == nullptr || wkbFlatten(geometry->getGeometryType()) != wkbPoint ||
        geometry->IsEmpty()) {
      throw Error(ErrorCode::invalid_argument, "feature " + std::to_string(id) + " is no point",
                  path);
    }
    points.push_back({geometry->toPoint()->getX(), geometry->toPoint()->getY()});
  });
  return points;
}

std::vector<std::vector<MapPoint>> read_lines(const std::string& text, const std::string& crs_wkt) {
  std::vector<std::vector<MapPoint>> lines;
  read_geometries(text, {"LINESTRING", "MULTILINESTRING"}, "LINESTRING(x y, x y)", crs_wkt,
                  [&](const OGRGeometry& geometry) { add_lines(geometry, lines); });
  if (lines.empty()) {
    const std::string where = text.size() > 64 ? text.substr(0, 64) + "..." : text;
    throw Error(ErrorCode::invalid_argument, "holds no line", where);
  }
  return lines;
}

}  // namespace ptin::tools
