// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters that a first pass thins: larger and smaller than its squares, with holes, plains and fractions.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/construct/test_terrain.h"

namespace ptin::test {

inline double slopes(int x, int y) {
  return 40.0 * std::sin(0.11 * x) * std::cos(0.07 * y) + 0.5 * x + (x * 7 + y * 13) % 5;
}

/// Larger than a square of right triangles, and no multiple of it.
inline oracle::RasterSpec mountains() {
  oracle::RasterSpec spec;
  spec.name = "mountains";
  spec.width = 107;
  spec.height = 83;
  spec.code = [](int x, int y) { return std::floor(slopes(x, y)); };
  return spec;
}

inline std::vector<oracle::RasterSpec> specs() {
  std::vector<oracle::RasterSpec> all(8, mountains());
  all[1].name = "mountains in fractions";
  all[1].heights = oracle::kFloat;
  all[1].code = [](int x, int y) { return static_cast<double>(static_cast<float>(slopes(x, y))); };
  all[2].name = "holes";
  all[2].valid = [](int x, int y) {
    return std::hypot(x - 40, y - 30) > 9 && (x * 31 + y * 17) % 211 != 0;
  };
  all[3].name = "a sea";
  all[3].code = [](int x, int y) { return std::max(12.0, std::floor(slopes(x, y))); };
  all[4].name = "far from the origin";
  all[4].origin = {kGridMax - 200, kGridMax - 129};
  all[5].name = "too small for a square";
  all[5].width = 33;
  all[5].height = 32;
  all[6].name = "a coast of voids";
  all[6].valid = [](int x, int y) { return x + y / 3 < 60; };
  all[7].name = "all void";
  all[7].valid = [](int, int) { return false; };
  return all;
}

}  // namespace ptin::test
