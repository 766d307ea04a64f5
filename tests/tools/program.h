// SPDX-License-Identifier: GPL-3.0-or-later
//
// Runs the built program and looks at what it says, returns and leaves behind.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/test_folder.h"

namespace ptin::tools::testing {

using test::TestFolder;

struct Outcome {
  int status = -1;  ///< Exit status; 128 + signal when a signal ended it.
  std::string out;
  std::string err;
};

/// Runs `ptin ARGUMENTS` with its output going to a file that is there. Only status and err are
/// set.
Outcome run_ptin_into(const std::string& output, const std::vector<std::string>& arguments);

/// Runs `ptin ARGUMENTS`. With `signal`, sends it `after` the start.
Outcome run_ptin(const std::vector<std::string>& arguments,
                 std::optional<int> signal = std::nullopt,
                 std::chrono::milliseconds after = std::chrono::milliseconds(0));

/// Runs `ptin ARGUMENTS` with these bytes on its standard input.
Outcome run_ptin_reading(const std::string& input, const std::vector<std::string>& arguments);

[[nodiscard]] std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& content);
/// Number of lines that are not empty.
[[nodiscard]] std::size_t lines_in(const std::string& text);

/// A raster to build from.
struct RasterRecipe {
  int width = 33;
  int height = 33;
  std::function<double(int column, int row)> value;
  std::optional<double> nodata;
  double west = 500000.0;
  double north = 4000000.0;
  double pixel = 30.0;
  bool columns_go_west = false;  ///< The first column is the easternmost: a negative pixel width.
  int epsg = 32611;
  std::string type = "Float32";       ///< By GDAL's name.
  std::string unit;                   ///< Of the heights, as the band declares it.
  std::vector<std::string> creation;  ///< Options of GDAL's driver.
};
/// Writes it as a GeoTIFF.
void make_raster(const std::string& path, const RasterRecipe& recipe);
/// Hills: smooth, no two alike, about 100 m high.
[[nodiscard]] double hills(int column, int row);

/// A small real terrain of tests/data.
[[nodiscard]] std::string test_data(const std::string& name);
/// The same, built into `folder` without a word; returns the store's path.
[[nodiscard]] std::string built(const TestFolder& folder, const std::string& name);

/// Runs ptin and expects success.
void expect_done(const std::vector<std::string>& arguments);
/// The same; returns what it printed as JSON.
[[nodiscard]] nlohmann::json answer_of(const std::vector<std::string>& arguments);

}  // namespace ptin::tools::testing
