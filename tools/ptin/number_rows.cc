// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ptin/number_rows.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string_view>

#include <ogrsf_frmts.h>

#include "engine/error.h"

namespace ptin::tools {

namespace {

constexpr std::string_view kSeparators = " \t,;\r";

/// The numbers at the beginning of a line, at most `most`.
std::size_t parse_numbers(std::string_view line, std::size_t most, std::vector<double>& out) {
  std::size_t count = 0;
  while (count < most) {
    const std::size_t begin = line.find_first_not_of(kSeparators);
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    if (line.front() == '+') line.remove_prefix(1);
    double value = 0.0;
    const auto [end, fault] = std::from_chars(line.data(), line.data() + line.size(), value);
    const auto used = static_cast<std::size_t>(end - line.data());
    if (fault != std::errc() ||
        (used < line.size() && kSeparators.find(line[used]) == std::string_view::npos)) {
      break;
    }
    out.push_back(value);
    line.remove_prefix(used);
    ++count;
  }
  return count;
}

std::vector<double> rows_of(std::istream& in, const std::string& name, std::size_t columns) {
  std::vector<double> rows;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(kSeparators) == std::string::npos) continue;
    const std::size_t found = parse_numbers(line, columns, rows);
    if (found == columns) continue;
    rows.resize(rows.size() - found);
    if (number == 1 && found == 0) continue;  // a header
    throw Error(ErrorCode::invalid_argument,
                "line " + std::to_string(number) + " has " + std::to_string(found) +
                    " numbers, expected " + std::to_string(columns) +
                    " separated by commas or spaces",
                name);
  }
  return rows;
}

void require_file(const std::string& path) {
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorCode::not_found, "no such file", path);
  }
}

using DatasetPtr = std::unique_ptr<GDALDataset>;

DatasetPtr open_vectors(const std::string& path) {
  require_file(path);
  DatasetPtr data(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr,
                                    nullptr, nullptr));
  if (!data || data->GetLayer(0) == nullptr) {
    throw Error(ErrorCode::invalid_argument,
                "neither text of numbers nor a vector file that GDAL reads", path);
  }
  return data;
}

bool is_text(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return path == "-" || extension == ".csv" || extension == ".txt" || extension == ".xyz" ||
         extension.empty();
}

std::vector<MapPoint> line_of(const OGRGeometry& geometry) {
  std::vector<MapPoint> points;
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbLineString) {
    const OGRLineString* line = geometry.toLineString();
    for (int i = 0; i < line->getNumPoints(); ++i) points.push_back({line->getX(i), line->getY(i)});
  } else if (type == wkbMultiLineString && !geometry.IsEmpty()) {
    return line_of(*geometry.toMultiLineString()->getGeometryRef(0));
  }
  return points;
}

std::vector<MapPoint> line_of_wkt(const std::string& wkt) {
  OGRGeometry* raw = nullptr;
  const OGRErr status = OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &raw);
  const std::unique_ptr<OGRGeometry> geometry(raw);
  return status == OGRERR_NONE && geometry ? line_of(*geometry) : std::vector<MapPoint>();
}

}  // namespace

std::vector<double> read_rows(const std::string& path, std::size_t columns) {
  if (path == "-") return rows_of(std::cin, "standard input", columns);
  require_file(path);
  std::ifstream in(path);
  return rows_of(in, path, columns);
}

std::vector<MapPoint> read_points(const std::string& path) {
  std::vector<MapPoint> points;
  if (is_text(path)) {
    const std::vector<double> rows = read_rows(path, 2);
    for (std::size_t i = 0; i + 1 < rows.size(); i += 2) points.push_back({rows[i], rows[i + 1]});
    return points;
  }
  const DatasetPtr data = open_vectors(path);
  for (const auto& feature : *data->GetLayer(0)) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr || wkbFlatten(geometry->getGeometryType()) != wkbPoint ||
        geometry->IsEmpty()) {
      throw Error(ErrorCode::invalid_argument,
                  "feature " + std::to_string(feature->GetFID()) + " is no point", path);
    }
    points.push_back({geometry->toPoint()->getX(), geometry->toPoint()->getY()});
  }
  return points;
}

std::vector<MapPoint> read_line(const std::string& text) {
  std::vector<MapPoint> points = line_of_wkt(text);
  if (!points.empty()) return points;
  if (!std::filesystem::exists(text)) {
    throw Error(ErrorCode::not_found,
                "no such file, and not WKT either; write LINESTRING(x y, x y) or name a file",
                text);
  }
  std::ifstream in(text);
  std::string start(65536, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  points = line_of_wkt(start);
  if (!points.empty()) return points;
  const DatasetPtr data = open_vectors(text);
  for (const auto& feature : *data->GetLayer(0)) {
    if (feature->GetGeometryRef() != nullptr) points = line_of(*feature->GetGeometryRef());
    if (!points.empty()) return points;
  }
  throw Error(ErrorCode::invalid_argument, "holds no line", text);
}

}  // namespace ptin::tools
