// SPDX-License-Identifier: GPL-3.0-or-later
//
// Terrains that are void but for some pixels, and what is said of them.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools::testing {

inline constexpr const char* kNoSurface = "has no surface, all of it is void";

class NoSurface : public ::testing::Test {
 public:
  using Arguments = std::vector<std::string>;

 protected:
  /// Builds a raster of 20 x 20 pixels of 30 m, void but for these pixels; returns what build said.
  Outcome build(const std::vector<std::array<int, 2>>& pixels, const Arguments& more = {}) {
    RasterRecipe recipe;
    recipe.width = recipe.height = 20;
    recipe.nodata = -9999.0;
    recipe.value = [&](int column, int row) {
      const bool has_height =
          std::find(pixels.begin(), pixels.end(), std::array{column, row}) != pixels.end();
      return has_height ? 100.0 + column : -9999.0;
    };
    make_raster(file("r.tif"), recipe);
    Arguments words = {"build", file("r.tif"), "-o", store(), "--overwrite"};
    words.insert(words.end(), more.begin(), more.end());
    return run_ptin(words);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string store() const { return file("r.ptin"); }
  /// What stderr says of a command that is done.
  static std::string warned(const Arguments& words) {
    const Outcome outcome = run_ptin(words);
    EXPECT_EQ(outcome.status, 0) << words[0] << outcome.err;
    return outcome.err;
  }
  static bool has(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  }

 private:
  TestFolder folder_;
};

}  // namespace ptin::tools::testing
