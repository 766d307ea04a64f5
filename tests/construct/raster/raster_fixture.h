// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters of every kind in GDAL's memory files, so that each test shows what it reads.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <gdal.h>
#include <gtest/gtest.h>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/raster/raster_source.h"
#include "engine/error.h"

namespace ptin::raster_fixture {

/// A raster to be written; row 0 is the file's first row.
struct Made {
  int columns = 0, rows = 0;
  std::vector<double> values;
  GDALDataType type = GDT_Int16;
  std::optional<std::array<double, 6>> geotransform =
      std::array<double, 6>{100, 10, 0, 230, 0, -10};
  std::optional<double> nodata;
  double scale = 1.0, offset = 0.0;
  std::string srs = "EPSG:32611";
  std::string unit;
  int bands = 1;
  std::vector<std::uint8_t> alpha;  ///< A second band.
  std::vector<std::string> creation;
  std::string name = "/vsimem/made.tif";
};

/// @return its name
std::string write(const Made& made);

/// 3 x 2 samples; the file's rows are 1 2 3 (north) and 4 5 6 (south).
[[nodiscard]] Made small();

RasterSource open(const Made& made, const SourceOptions& options = {});

using Heights = std::vector<double>;
inline constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();

/// All heights, row 0 in the south; NaN where void.
[[nodiscard]] Heights heights_of(const RasterSource& source);
/// Equal, with NaN equal to itself.
void expect_heights(const RasterSource& source, const Heights& expected);

/// What `call` throws; a failure of the test when that is nothing.
template <class Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "no error was thrown";
  return Error(ErrorCode::internal, "none");
}
[[nodiscard]] Error open_error(const std::vector<std::string>& paths, std::stop_token stop = {});
/// Opening it is an invalid argument, said with `word` and the file's name.
void expect_refused(const Made& made, const std::string& word, const SourceOptions& options = {});

}  // namespace ptin::raster_fixture
