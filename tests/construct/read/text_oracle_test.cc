// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points as text, read once more by readers that are not ours: GDAL's of CSV and of XYZ. The build and
// `verify --against` read a text by one reader, so a fault of it shows here or nowhere.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/read/xyz_reader.h"
#include "tests/construct/memory_file.h"

namespace ptin {
namespace {

using Point = std::array<double, 3>;

std::vector<Point> read_here(const std::string& path) {
  XyzReader reader(path);
  std::vector<Point> points;
  for (SourcePoint p; reader.next(p);) {
    points.push_back({to_double(p.x), to_double(p.y), to_double(p.z)});
  }
  return points;
}

/// By OGR's driver of CSV, whose fields are taken as text and made numbers by the C library.
std::vector<Point> read_by_ogr(const std::string& path) {
  GDALAllRegister();
  const char* const drivers[] = {"CSV", nullptr};
  const char* const options[] = {"AUTODETECT_TYPE=NO", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR, drivers, options));
  std::vector<Point> points;
  if (data == nullptr) {
    return points;
  }
  for (const auto& feature : data->GetLayer(0)) {
    const auto number = [&](const char* name) {
      return std::strtod(feature->GetFieldAsString(name), nullptr);
    };
    points.push_back({number("x"), number("y"), number("z")});
  }
  return points;
}

/// Makes awkward tables of points, whose columns are x, y, z and a name in any order.
class AwkwardTable {
 public:
  explicit AwkwardTable(std::uint32_t seed) : random_(seed) {
    separator_ = one_of({",", ";", "\t"});
    line_end_ = one_of({"\n", "\r\n", "\r"});
  }
  std::string text() {
    std::vector<std::string> columns = {"x", "y", "z", "name"};
    std::shuffle(columns.begin(), columns.end(), random_);
    std::string text = is_so() ? "\xEF\xBB\xBF" : "";
    const auto add_row = [&](const auto& field_of) {
      for (std::size_t i = 0; i < columns.size(); ++i) {
        text += (i == 0 ? "" : separator_) + field_of(columns[i]);
      }
      text += line_end_;
    };
    add_row([&](const std::string& column) { return is_so() ? quoted(column) : column; });
    for (auto rows = 1 + random_() % 12; rows > 0; --rows) {
      add_row([&](const std::string& column) { return column == "name" ? name() : number(); });
    }
    if (is_so()) {
      text.resize(text.size() - line_end_.size());
    }
    return text;
  }

 private:
  bool is_so() { return random_() % 2 == 0; }
  std::string one_of(const std::vector<std::string>& all) { return all[random_() % all.size()]; }
  static std::string quoted(const std::string& field) {
    std::string text = "\"";
    for (const char c : field) {
      text += c == '"' ? std::string("\"\"") : std::string(1, c);
    }
    return text + "\"";
  }
  std::string number() {
    const std::string digits = std::to_string(random_() % 100000);
    const std::string text = one_of({"", "-", "+"}) +
                             one_of({digits, digits + ".", "." + digits, digits + "." + digits}) +
                             one_of({"", "", "e2", "E-3", "e+1"});
    return is_so() ? text : quoted(text);
  }
  std::string name() {
    std::string text = one_of({"", "old tree", "a \"big\" one", "\"", "# 7", "// x", "1,5;2"});
    for (int i = 0; i < 3; ++i) {
      text += one_of({"", separator_, " ", "\"", line_end_ == "\r" ? "" : line_end_, "t"});
    }
    return text.find_first_of("\"#/,;\t\r\n") == std::string::npos && is_so() ? text : quoted(text);
  }

  std::mt19937 random_;
  std::string separator_, line_end_;
};

RC_GTEST_PROP(XyzReader, ReadsAwkwardTablesAsOgrDoes, (std::uint32_t seed)) {
  const std::string text = AwkwardTable(seed).text();
  const MemoryFile file("awkward.csv", text);
  const std::vector<Point> expected = read_by_ogr(file.path());
  RC_LOG() << text;
  RC_ASSERT(!expected.empty());
  RC_ASSERT(read_here(file.path()) == expected);
}

/// A grid of heights, a line a sample, from the north-western one.
RC_GTEST_PROP(XyzReader, ReadsGridsAsGdalDoes, (std::uint32_t seed)) {
  std::mt19937 random(seed);
  const auto within = [&](std::uint32_t low, std::uint32_t high) {
    return static_cast<int>(low + random() % (high - low + 1));
  };
  const int columns = within(2, 9), rows = within(2, 9);
  const std::vector<std::string> separators = {" ", "\t", ",", ";"}, ends = {"\n", "\r\n"};
  const std::string& separator = separators[random() % separators.size()];
  const std::string& end = ends[random() % ends.size()];
  std::string text = random() % 2 == 0 ? "x" + separator + "y" + separator + "z" + end : "";
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      text += std::to_string(500000 + 25 * column) + ".5" + separator +
              std::to_string(4000000 - 25 * row) + separator + std::to_string(within(0, 5000)) +
              "." + std::to_string(within(0, 9)) + end;
    }
  }
  const MemoryFile file("grid.xyz", text);
  GDALAllRegister();
  const char* const drivers[] = {"XYZ", nullptr};
  const GDALDatasetUniquePtr data(GDALDataset::Open(file.path().c_str(), GDAL_OF_RASTER, drivers));
  RC_LOG() << text;
  RC_ASSERT(data != nullptr);
  RC_ASSERT(data->GetRasterXSize() == columns);
  RC_ASSERT(data->GetRasterYSize() == rows);
  std::array<double, 6> place{};
  RC_ASSERT(data->GetGeoTransform(place.data()) == CE_None);
  std::vector<float> heights(static_cast<std::size_t>(columns * rows));
  RC_ASSERT(data->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, columns, rows, heights.data(), columns,
                                             rows, GDT_Float32, 0, 0, nullptr) == CE_None);
  const std::vector<Point> points = read_here(file.path());
  RC_ASSERT(points.size() == heights.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto column = static_cast<double>(i % static_cast<std::size_t>(columns)) + 0.5;
    const auto row = static_cast<double>(i / static_cast<std::size_t>(columns)) + 0.5;
    RC_ASSERT(points[i][0] == place[0] + column * place[1]);
    RC_ASSERT(points[i][1] == place[3] + row * place[5]);
    RC_ASSERT(static_cast<float>(points[i][2]) == heights[i]);
  }
}

}  // namespace
}  // namespace ptin
