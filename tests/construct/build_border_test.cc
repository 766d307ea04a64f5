// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points with gaps, and the same surfaces as TINs, built through a tree of tiles: the border between
// surface and void moves by no more than a tolerance allows (engine/DESIGN.md, section 3.2).
#include <cmath>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/construct/border_oracle.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/test_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

/// Points stand about a spacing apart where `valid` is true of the column and row.
constexpr int kSpacing = 8;

struct Shape {
  std::string name;
  std::function<bool(int column, int row)> valid;
};

std::vector<Shape> shapes() {
  const auto from_middle = [](int x, int y) { return std::hypot(x - 12, y - 12); };
  return {
      {"comb", [](int x, int y) { return x < 5 || y % 6 < 3; }},
      {"spiral",
       [=](int x, int y) {
         const double turn = std::atan2(y - 12, x - 12) / 6.2831853;
         return std::fmod(from_middle(x, y) / 6 + 1 - turn, 1.0) > 0.45;
       }},
      {"thin dam", [](int x, int y) { return x < 9 || x > 17 || y == 10 || y == 11; }},
      {"chain of islands", [](int x, int y) { return std::hypot(x % 8 - 3, y % 8 - 4) < 2.2; }},
      {"hole of few triangles",
       [](int x, int y) { return std::abs(x - 12) + std::abs(y - 9) > 1; }},
      {"two regions", [](int x, int y) { return std::abs(x + y / 2 - 15) > 1; }},
      {"two regions with lone points between",
       [](int x, int y) { return std::abs(x - 12) > 3 || (x == 12 && y % 3 == 0); }},
  };
}

std::string made_points(const Shape& shape, const std::string& path) {
  std::mt19937_64 random(20);
  std::uniform_int_distribution<int> off(-2, 2);
  std::ofstream text(path);
  text << "x y z\n";
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const int dx = off(random), dy = off(random);
      if (!shape.valid(x, y)) continue;
      const double z = std::floor(9 * std::sin(x / 4.0) + 7 * std::cos((y - x) / 3.0));
      text << kSpacing * x + dx << ' ' << kSpacing * y + dy << ' ' << z << '\n';
    }
  }
  return path;
}

/// The surface of a store as OBJ.
std::string surface_of(const Terrain& terrain, const std::string& path) {
  const RefinedTin full = terrain.refine({});
  const StoreFacts& facts = terrain.store().facts();
  std::ofstream text(path);
  for (const Vertex& v : full.tin.vertices) {
    const MapPoint p = facts.map.to_map(v.position.x, v.position.y);
    text << "v " << p.x << ' ' << p.y << ' ' << facts.heights.height(v.height) << '\n';
  }
  for (TriangleId t = 0; t < full.tin.triangles.size(); ++t) {
    if (full.tin.classes[t] == TriangleClass::kVoid) continue;
    text << 'f';
    for (const VertexId v : full.tin.triangles[t].v) text << ' ' << v + 1;
    text << '\n';
  }
  return path;
}

void expect_border_kept(const Terrain& terrain, const std::string& name) {
  oracle::TestTerrain source;
  source.name = name;
  source.slope = terrain.store().facts().map.step_x;
  source.full = terrain.refine({}).tin;
  for (const double tolerance : test::some_of({0.0, 2.0, 4.0, 7.0, 9.0, 12.0, 20.0, 30.0, 40.0})) {
    RefineRequest request;
    request.detail.tolerance = tolerance;
    const RefinedTin level = terrain.refine(request);
    ASSERT_EQ(validate(level.tin), "");
    EXPECT_EQ(oracle::check_border(source, level.tin, tolerance), "");
  }
}

TEST(BuildOverTiles, KeepsTheBorderOfPointsAndOfTins) {
  for (const Shape& shape : test::some_of(shapes())) {
    const oracle::ScratchFolder folder;
    const std::string points = made_points(shape, folder.file("points.xyz"));
    for (const std::int64_t tile : {6, 256}) {
      SCOPED_TRACE(shape.name + ", tiles of " + std::to_string(tile));
      BuildOptions options;
      options.tile = tile;
      options.max_edge = 2.2 * kSpacing;
      const std::string of_points = folder.file("points" + std::to_string(tile) + ".ptin");
      build({points}, of_points, options, {});
      const Terrain terrain = Terrain::open(of_points);
      ASSERT_FALSE(terrain.store().facts().free_of_voids);
      expect_border_kept(terrain, shape.name);
      if (tile == 256) continue;
      options.max_edge.reset();
      const std::string of_tin = folder.file("tin" + std::to_string(tile) + ".ptin");
      build({surface_of(terrain, folder.file("surface.obj"))}, of_tin, options, {});
      expect_border_kept(Terrain::open(of_tin), shape.name + " as a TIN");
    }
  }
}

}  // namespace
}  // namespace ptin
