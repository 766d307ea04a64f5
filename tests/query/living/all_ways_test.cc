// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights, stars and splits on made rasters that have several tiles of heights, with voids on their
// borders; and what asking by heights costs, and where it is refused.
#include "tests/query/living/all_ways.h"

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/build.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using reference::AllWays;

/// Heights of a made raster: plateaus and steps, so that cells have equal diagonals and corners.
double made_height(std::mt19937_64& random, int kind, int x, int y) {
  switch (kind) {
    case 0:
      return (x / 5 + y / 4) % 3;
    case 1:
      return static_cast<double>(random() % 7);
    case 2:
      return 0.25 * static_cast<double>(random() % 9) - 1;
    case 3:
      return 12 * std::sin(0.2 * x) * std::cos(0.15 * y) +
             0.001 * static_cast<double>(random() % 3);
    default:
      return std::floor(40 * std::sin(0.1 * x) * std::cos(0.07 * y));
  }
}

/// Writes a raster of up to three tiles each way, whose voids lie about borders of tiles, in runs and one
/// by one.
void write_raster(std::mt19937_64& random, const std::string& path) {
  const int columns = 2 + static_cast<int>(random() % 99),
            rows = 2 + static_cast<int>(random() % 70);
  const int kind = static_cast<int>(random() % 5), voids = static_cast<int>(random() % 4);
  std::ofstream out(path);
  out << "ncols " << columns << "\nnrows " << rows
      << "\nxllcorner -0.5\nyllcorner -0.5\ncellsize 1\nNODATA_value -9999\n";
  out.precision(9);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const bool is_near = x % 32 < 2 || y % 32 > 29;
      const bool is_void = (voids == 1 && random() % 9 == 0) ||
                           (voids == 2 && is_near && random() % 3 == 0) ||
                           (voids == 3 && (x / 20 + y / 17) % 4 == 1);
      out << (is_void ? -9999 : made_height(random, kind, x, y)) << ' ';
    }
    out << '\n';
  }
}

RC_GTEST_PROP(AllWays, AnswerTheSameOfAnyRaster, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const test::TestFolder folder;
  write_raster(random, folder.file("a.asc"));
  BuildOptions options;
  options.a_srs = "EPSG:32611";
  build({folder.file("a.asc")}, folder.file("a.ptin"), options, {});
  const Terrain terrain = Terrain::open(folder.file("a.ptin"));
  const bool has_heights = terrain.floor() != nullptr;
  RC_ASSERT(has_heights);
  reference::expect_same_by_all_ways(
      terrain, {.points = 120, .splits = 120, .lines = 6, .windows = 2}, seed);
  RC_ASSERT(!testing::Test::HasFailure());
}

/// What an answer says of the line, and where.
std::string told(const SightResult& r) {
  std::ostringstream text;
  text.precision(17);
  text << static_cast<int>(r.verdict) << ' ' << r.length << ' ' << r.clearance_min << ' '
       << r.clearance_max << ' ' << r.void_length;
  for (const auto& at : {r.obstruction, r.clearance_at}) {
    if (at) text << ' ' << at->distance;
  }
  return text.str();
}

// Of isles on one level many points of a line have the same clearance.
TEST(AllWays, NameTheFirstPointOfLeastClearance) {
  std::mt19937_64 random(5);
  const test::TestFolder folder;
  std::ofstream out(folder.file("a.asc"));
  constexpr int kSide = 40;
  out << "ncols 40\nnrows 40\nxllcorner -0.5\nyllcorner -0.5\ncellsize 1\nNODATA_value -9999\n";
  for (int i = 0; i < kSide * kSide; ++i) out << (random() % 9 < 4 ? -9999 : 7) << '\n';
  out.close();
  BuildOptions options;
  options.a_srs = "EPSG:32611";
  build({folder.file("a.asc")}, folder.file("a.ptin"), options, {});
  const Terrain terrain = Terrain::open(folder.file("a.ptin"));
  SightRequest request;
  request.curvature.coefficient = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<double>(random() % 40), y = static_cast<double>(random() % 30);
    const auto along = static_cast<double>(2 + random() % 8);
    const MapPoint ends[] = {{x + along, y}, {x, y + along}, {x + along, y + along}};
    const SightPair pair{{x, y}, 30, ends[random() % 3], 30};
    const std::string by_heights = told(terrain.sight(pair, request, AnswerBy::kHeights));
    EXPECT_EQ(by_heights, told(terrain.sight(pair, request, AnswerBy::kStars)));
    EXPECT_EQ(by_heights, told(terrain.sight(pair, request, AnswerBy::kSplits)));
  }
}

TEST(AllWays, AnswerTheSameOfRealRasters) {
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    SCOPED_TRACE(name);
    reference::expect_same_by_all_ways(reference::built_terrain(name), {.points = 3000}, 1);
  }
}

std::string refusal_of(const Terrain& terrain, const LocateRequest& request) {
  const MapPoint at = terrain.store().facts().map.to_map(3.5, 3.25);
  try {
    static_cast<void>(terrain.locate({&at, 1}, request, AnswerBy::kHeights));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    return e.message();
  }
  return "";
}

TEST(Heights, AreRefusedWhereTheyCannotAnswer) {
  const Terrain& exact = reference::built_terrain("mountains_257.tif");
  EXPECT_EQ(refusal_of(exact, {}), "");
  LocateRequest request;
  request.detail.tolerance = 0.0;
  EXPECT_NE(refusal_of(exact, request).find("a level of detail"), std::string::npos);
  const Terrain& rough = reference::built_terrain("mountains_257.tif", 3.0);
  EXPECT_NE(refusal_of(rough, {}).find("no heights of a raster"), std::string::npos);
}

}  // namespace
}  // namespace ptin
