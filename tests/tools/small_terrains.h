// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that the tests of the program and of the service begin with, made by the library: small
// terrains and what they are built from.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/construct/build_options.h"
#include "tests/support/test_folder.h"

namespace ptin::tools::testing {

using test::TestFolder;

[[nodiscard]] std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& content);

/// A raster to build from.
struct RasterRecipe {
  int width = 33;
  int height = 33;
  std::function<double(int column, int row)> value{};
  std::optional<double> nodata{};
  double west = 500000.0;
  double north = 4000000.0;
  double pixel = 30.0;
  bool columns_go_west = false;  ///< The first column is the easternmost: a negative pixel width.
  int epsg = 32611;              ///< 0: no CRS.
  std::string type = "Float32";  ///< By GDAL's name.
  std::string unit{};            ///< The unit of the heights, as the band declares it.
  std::vector<std::string> creation{};  ///< Options of GDAL's driver.
};
/// Writes it as a GeoTIFF.
void make_raster(const std::string& path, const RasterRecipe& recipe);
/// Hills: smooth, no two alike, about 100 m high.
[[nodiscard]] double hills(int column, int row);

/// A small real terrain of tests/data.
[[nodiscard]] std::string test_data(const std::string& name);
/// The path of the store of such a terrain in `folder`. It is built once a run of ctest's, or once a process, and copied.
/// Under the thread sanitizer it is of the terrain's north-western quarter.
[[nodiscard]] std::string built(const TestFolder& folder, const std::string& name);
[[nodiscard]] std::string built(const TestFolder& folder, const std::string& name,
                                const std::string& store_name);
/// Builds a terrain.
void build_terrain(const std::string& input, const std::string& output,
                   const BuildOptions& options = {});

}  // namespace ptin::tools::testing
