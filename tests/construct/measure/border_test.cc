// SPDX-License-Identifier: GPL-3.0-or-later
//
// The border of voids of made shapes moves by no more than a tolerance allows (engine/DESIGN.md,
// section 3.2).
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/mesh/validate.h"
#include "tests/construct/border_oracle.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

using oracle::RasterSpec;
using oracle::TestTerrain;

RasterSpec shape(const std::string& name, std::function<bool(int, int)> valid) {
  RasterSpec spec;
  spec.name = name;
  spec.width = spec.height = 48;
  spec.slope = 1.0;
  spec.code = [](int x, int y) {
    return std::floor(9 * std::sin(x / 7.0) + 7 * std::cos((y - x) / 5.0));
  };
  spec.valid = std::move(valid);
  return spec;
}

std::vector<RasterSpec> shapes() {
  const auto from_middle = [](int x, int y) { return std::hypot(x - 24, y - 24); };
  return {
      shape("comb", [](int x, int y) { return x < 10 || y % 4 < 2; }),
      shape("comb of voids", [](int x, int y) { return x < 10 || y % 4 != 0; }),
      shape("spiral",
            [=](int x, int y) {
              const double turn = std::atan2(y - 24, x - 24) / 6.2831853;
              return std::fmod(from_middle(x, y) / 9 + 1 - turn, 1.0) > 0.35;
            }),
      shape("thin dam", [](int x, int y) { return x < 18 || x > 30 || y == 20 || y == 21; }),
      shape("slanted dam",
            [](int x, int y) { return x < 14 || x > 34 || std::abs(2 * y - x) < 3; }),
      shape("chain of islands",
            [](int x, int y) { return std::hypot(x % 12 - 6, y % 9 - 4) < 2.2 + x / 12 * 0.5; }),
      shape("holes of one sample", [](int x, int y) { return x % 7 != 3 || y % 5 != 2; }),
      shape("one sample's cell amid void",
            [](int x, int y) { return (x == 20 || x == 21) && (y == 20 || y == 21); }),
      shape("two regions a step apart", [](int x, int y) { return x + y / 3 != 30; }),
      shape("disc", [=](int x, int y) { return from_middle(x, y) < 19.5; }),
      shape("ring", [=](int x, int y) { return std::abs(from_middle(x, y) - 16) < 3; }),
  };
}

TEST(Border, OfMadeShapesMovesByNoMoreThanTheToleranceAllows) {
  for (const RasterSpec& spec : test::some_of(shapes())) {
    SCOPED_TRACE(spec.name);
    const TestTerrain terrain = oracle::simplified(oracle::make_raster(spec));
    for (const double tolerance : test::some_of({0.0, 0.4, 0.75, 1.0, 2.0, 3.0, 6.0, 12.0})) {
      std::string fault;
      const Tin tin = oracle::refined(
          terrain.tile.tin, terrain.tile.records,
          [&](const VertexSplit& r) { return r.error > tolerance; }, fault);
      ASSERT_EQ(fault, "");
      ASSERT_EQ(validate(tin), "");
      EXPECT_EQ(oracle::check_border(terrain, tin, tolerance), "");
    }
  }
}

/// What it takes to see a fault: a border that did move.
TEST(Border, OfACoarserTinIsFoundToHaveMoved) {
  const TestTerrain terrain = oracle::simplified(oracle::make_raster(shapes().front()));
  std::string fault;
  const Tin tin = oracle::refined(
      terrain.tile.tin, terrain.tile.records, [](const VertexSplit& r) { return r.error > 12.0; },
      fault);
  EXPECT_NE(oracle::check_border(terrain, tin, 0.5), "");
}

TEST(Border, IsSimplifiedWhereTheToleranceAllows) {
  const TestTerrain terrain = oracle::simplified(oracle::make_raster(shapes()[9]));
  std::string fault;
  const Tin tin = oracle::refined(
      terrain.tile.tin, terrain.tile.records, [](const VertexSplit& r) { return r.error > 3.0; },
      fault);
  EXPECT_LT(oracle::Border(tin).sides().size(), oracle::Border(terrain.full).sides().size() / 4);
}

}  // namespace
}  // namespace ptin
