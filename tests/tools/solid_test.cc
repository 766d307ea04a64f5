// SPDX-License-Identifier: GPL-3.0-or-later
//
// Solids to print: closed, outward, of the volume that lies between surface and base.
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::expect_refusal;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using Point = std::array<double, 3>;

/// Facets whose corners are numbered by their coordinates.
struct Facets {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

Facets facets_of(const std::vector<std::array<Point, 3>>& triangles) {
  Facets facets;
  std::map<Point, std::size_t> numbers;
  for (const auto& t : triangles) {
    std::array<std::size_t, 3> ids{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [found, is_new] = numbers.emplace(t[i], facets.points.size());
      if (is_new) facets.points.push_back(t[i]);
      ids[i] = found->second;
    }
    facets.triangles.push_back(ids);
  }
  return facets;
}

Facets read_stl(const std::string& path) {
  const std::string bytes = read_file(path);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84 + 50 * std::size_t{count});
  std::vector<std::array<Point, 3>> triangles(count);
  for (std::size_t t = 0; t < count; ++t) {
    std::array<float, 9> numbers{};
    std::memcpy(numbers.data(), bytes.data() + 84 + 50 * t + 12, sizeof numbers);
    for (std::size_t k = 0; k < 9; ++k) triangles[t][k / 3][k % 3] = numbers[k];
  }
  return facets_of(triangles);
}

/// The facets of a GLB, with z up again.
Facets read_solid_glb(const std::string& path) {
  const testing::ReadMesh mesh = testing::read_glb(read_file(path));
  Facets facets;
  for (const Point& p : mesh.vertices) facets.points.push_back({p[0], -p[2], p[1]});
  for (const auto& t : mesh.triangles) facets.triangles.push_back({t[0], t[1], t[2]});
  return facets;
}

/// Each directed edge has its opposite as often as itself, which is once but where borders touch.
/// @returns  how many edges have more than two triangles
std::size_t expect_closed(const Facets& facets) {
  std::map<std::pair<std::size_t, std::size_t>, int> edges;
  for (const auto& t : facets.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NE(t[i], t[(i + 1) % 3]);
      ++edges[{t[i], t[(i + 1) % 3]}];
    }
  }
  std::size_t shared = 0;
  for (const auto& [edge, times] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    EXPECT_EQ(opposite == edges.end() ? 0 : opposite->second, times);
    if (times > 1 && edge.first < edge.second) {
      ++shared;
      const Point& a = facets.points[edge.first];
      const Point& b = facets.points[edge.second];
      EXPECT_TRUE(a[0] == b[0] && a[1] == b[1]) << "an edge of walls, where borders touch";
    }
  }
  return shared;
}

double volume_of(const Facets& facets) {
  double six = 0;
  for (const auto& t : facets.triangles) {
    const Point& a = facets.points[t[0]];
    const Point& b = facets.points[t[1]];
    const Point& c = facets.points[t[2]];
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

class Solid : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string store(const std::function<bool(int, int)>& is_void) const {
    testing::RasterRecipe recipe;
    recipe.width = recipe.height = 17;
    recipe.nodata = -9999;
    recipe.value = [&](int c, int r) { return is_void(c, r) ? -9999 : testing::hills(c, r); };
    testing::make_raster(file("a.tif"), recipe);
    expect_done({"build", file("a.tif"), "-o", file("a.ptin"), "-q"});
    return file("a.ptin");
  }
  /// Cubic metres between the surface and a level below it.
  [[nodiscard]] double net_above(const std::string& store, const std::string& level) const {
    return answer_of({"volume", store, "--level", level, "--json"})["net"]["volume"];
  }
  TestFolder folder_;
};

TEST_F(Solid, IsClosedAndHasTheVolumeAboveItsBase) {
  const std::string terrain = store([](int, int) { return false; });
  const double expected = net_above(terrain, "-50");
  for (const char* command : {"refine", "export"}) {
    expect_done({command, terrain, "--solid", "-50", "-q", "-o", file("a.stl"), "--overwrite"});
    const Facets facets = read_stl(file("a.stl"));
    EXPECT_EQ(expect_closed(facets), 0U) << command;
    EXPECT_EQ(facets.triangles.size(), 2 * 2 * 16 * 16 + 2 * 4 * 16U);
    EXPECT_NEAR(volume_of(facets), expected, 1e-5 * expected) << command;
  }
  expect_done({"refine", terrain, "--solid", "-50", "-q", "-o", file("a.glb")});
  const Facets glb = read_solid_glb(file("a.glb"));
  EXPECT_EQ(expect_closed(glb), 0U);
  EXPECT_NEAR(volume_of(glb), expected, 1e-5 * expected);
}

TEST_F(Solid, HasVoidsAsHolesThrough) {
  // A hole, a bay, an islet in the hole, and two voids that touch in one sample.
  const std::string terrain = store([](int c, int r) {
    const bool hole = c > 3 && c < 9 && r > 3 && r < 9 && !(c >= 5 && c <= 7 && r >= 5 && r <= 7);
    return hole || (c > 13 && r == 8) || (c == 12 && r == 12) || (c == 14 && r == 14);
  });
  const double expected = net_above(terrain, "-1");
  for (const auto& more : {std::vector<std::string>{}, {"--error", "10"}}) {
    std::vector<std::string> words = {"refine", terrain, "--solid",     "-1",
                                      "-q",     "-o",    file("a.stl"), "--overwrite"};
    words.insert(words.end(), more.begin(), more.end());
    expect_done(words);
    const Facets refined = read_stl(file("a.stl"));
    expect_closed(refined);
    EXPECT_GT(volume_of(refined), 0);
    if (more.empty()) {
      EXPECT_NEAR(volume_of(refined), expected, 1e-5 * expected);
    }
    words[0] = "export";
    expect_done(words);
    const Facets exported = read_stl(file("a.stl"));
    expect_closed(exported);
    EXPECT_EQ(exported.triangles.size(), refined.triangles.size());
    EXPECT_NEAR(volume_of(exported), volume_of(refined), 1e-5 * volume_of(refined));
  }
}

TEST_F(Solid, IsCutWhereARegionIsCut) {
  const std::string terrain = store([](int, int) { return false; });
  expect_done({"refine", terrain, "--window", "500100", "3999700", "500250", "3999800", "--cut",
               "--solid", "-1", "-q", "-o", file("a.stl")});
  const Facets facets = read_stl(file("a.stl"));
  expect_closed(facets);
  EXPECT_GT(volume_of(facets), 150 * 100);
}

TEST_F(Solid, StandsAtItsScaleAndExaggerated) {
  const std::string terrain = store([](int, int) { return false; });
  const double expected = net_above(terrain, "-50");
  expect_done({"refine", terrain, "--solid", "-50", "--scale", "1:2000", "--exaggeration", "1.5",
               "-q", "-o", file("a.stl")});
  expect_done({"export", terrain, "--solid", "-50", "--scale", "2000", "--exaggeration", "1.5",
               "-q", "-o", file("b.stl")});
  const double in_millimetres = expected * 1.5 * std::pow(1000.0 / 2000, 3);
  for (const char* name : {"a.stl", "b.stl"}) {
    const Facets facets = read_stl(file(name));
    expect_closed(facets);
    EXPECT_NEAR(volume_of(facets), in_millimetres, 1e-5 * in_millimetres);
  }
  expect_done({"refine", terrain, "--solid", "-50", "--scale", "2000", "-q", "-o", file("a.glb")});
  EXPECT_NEAR(volume_of(read_solid_glb(file("a.glb"))), expected / 8e9, 1e-4 * expected / 8e9);
}

TEST_F(Solid, RefusesABaseThatIsNotBelowAndOtherFormats) {
  const std::string terrain = store([](int, int) { return false; });
  const std::string out = file("a.stl");
  for (const char* command : {"refine", "export"}) {
    expect_refusal(run_ptin({command, terrain, "--solid", "5000", "-q", "-o", out}), 2,
                   "--solid: the base must be below");
    expect_refusal(run_ptin({command, terrain, "--solid", "nan", "-o", out}), 2, "--solid");
    expect_refusal(run_ptin({command, terrain, "--scale", "1:0", "-o", out}), 2, "no scale");
    expect_refusal(run_ptin({command, terrain, "--scale", "25k", "-o", out}), 2, "no scale");
    expect_refusal(run_ptin({command, terrain, "--exaggeration", "0", "-o", out}), 2,
                   "--exaggeration");
    expect_refusal(run_ptin({command, terrain, "--solid", "0", "-o", file("a.ply")}), 2,
                   "write .stl or .glb");
  }
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.ptin", "a.tif"}));
}

}  // namespace
}  // namespace ptin::tools
