// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain with a wall, and positions on it.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

/// A wall of 100 across flat ground of 10, 30 m pixels; the north-eastern corner is void.
inline std::string wall(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    if (column > 28 && row < 4) return -9999.0;
    return column == 16 ? 100.0 : 10.0;
  };
  make_raster(folder.file("wall.tif"), recipe);
  const Outcome built =
      run_ptin({"build", folder.file("wall.tif"), "-o", folder.file("wall.ptin"), "-q"});
  EXPECT_EQ(built.status, 0) << built.err;
  return folder.file("wall.ptin");
}

inline constexpr double kWest = 500015.0;    // centre of the western column
inline constexpr double kNorth = 3999985.0;  // centre of the northern row

inline std::string east(double columns) { return std::to_string(kWest + 30 * columns); }
inline std::string south(double rows) { return std::to_string(kNorth - 30 * rows); }

}  // namespace ptin::tools::testing
