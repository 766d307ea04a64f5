// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters of one band, read whole.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace ptin::tools::testing {

struct ReadRaster {
  int width = 0, height = 0;
  std::array<double, 6> transform{};
  double nodata = 0.0;
  std::vector<double> values;
};

/// A failure of the test, and an empty raster, where it cannot be read.
[[nodiscard]] ReadRaster read_raster(const std::string& path);

}  // namespace ptin::tools::testing
