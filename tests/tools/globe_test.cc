// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a terrain is on the globe, and what its heights are measured from.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "engine/error.h"
#include "tests/tools/program.h"
#include "tests/tools/tiles_fixture.h"

namespace ptin::tools::testing {
namespace {

TEST(TerrainTiles, KnowWhereHeightsAreMeasuredFrom) {
  const auto datum_of = [](const char* crs) {
    OGRSpatialReference srs;
    EXPECT_EQ(srs.SetFromUserInput(crs), OGRERR_NONE);
    const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
    char* wkt = nullptr;
    EXPECT_EQ(srs.exportToWkt(&wkt, options), OGRERR_NONE);
    const CrsFacts facts = crs_facts(std::string(wkt));
    CPLFree(wkt);
    return vertical_datum(facts);
  };
  EXPECT_EQ(datum_of("EPSG:4979"), VerticalDatum::kEllipsoidal);
  EXPECT_EQ(datum_of("EPSG:32611+5773"), VerticalDatum::kOrthometric);
  EXPECT_EQ(datum_of("EPSG:4326+5703"), VerticalDatum::kOrthometric);
  EXPECT_EQ(datum_of("EPSG:32611"), VerticalDatum::kUnknown);
  EXPECT_EQ(vertical_datum({}), VerticalDatum::kUnknown);
}

TEST(TerrainTiles, CanBeAboveTheEllipsoid) {
  const TestFolder folder;
  const std::string path = folder.file("egm.ptin");
  expect_done(
      {"build", test_data("mountains_257.tif"), "--vertical-crs", "EPSG:5773", "-o", path, "-q"});
  TerrainTilesOptions options;
  options.globe.to_ellipsoid = true;
  const Terrain terrain = Terrain::open(path);
  const CrsFacts crs = crs_facts(terrain.store());
  std::unique_ptr<TerrainTiles> above;
  try {
    above = std::make_unique<TerrainTiles>(terrain, crs, options, limits_of());
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    GTEST_SKIP() << "needs PROJ's grid of EGM96";
  }
  const TerrainTiles as_is(terrain, crs, {}, limits_of());
  const int z = above->pyramid().finest_level();
  const auto rectangle = above->pyramid().rectangles(z).front();
  const ReadTerrain high = read_terrain_tile(
      above->tile({z, rectangle.min_x, rectangle.min_y, true, limits_of()})->bytes);
  const ReadTerrain low = read_terrain_tile(
      as_is.tile({z, rectangle.min_x, rectangle.min_y, true, limits_of()})->bytes);
  // EGM96 is 32 to 34 m below the ellipsoid near Los Angeles.
  EXPECT_NEAR(double(high.least) - double(low.least), -33.0, 2.0);
}

TEST(TerrainTiles, NeedToKnowWhereTheyAre) {
  const TestFolder folder;
  const Terrain nowhere = Terrain::open(built(folder, "ground_points.csv"));
  EXPECT_EQ(code_of([&] {
              const TerrainTiles tiles(nowhere, crs_facts(nowhere.store()), {}, limits_of());
            }),
            ErrorCode::invalid_argument);
  const Terrain unknown = Terrain::open(built(folder, "mountains_257.tif"));
  TerrainTilesOptions options;
  options.globe.to_ellipsoid = true;
  EXPECT_EQ(code_of([&] {
              const TerrainTiles tiles(unknown, crs_facts(unknown.store()), options, limits_of());
            }),
            ErrorCode::invalid_argument);
}

/// A grid of 96 km in a CRS around a pole.
StoreFacts polar_facts(double west, double south) {
  StoreFacts facts;
  facts.map = {west, south, 10.0, 10.0};
  facts.bounds = {0, 0, 9600, 9600};
  facts.heights = {HeightType::int32, 1.0, 0.0};
  facts.max_height = 1000.0;
  return facts;
}

CrsFacts facts_of(int epsg) {
  OGRSpatialReference srs;
  EXPECT_EQ(srs.importFromEPSG(epsg), OGRERR_NONE);
  char* wkt = nullptr;
  EXPECT_EQ(srs.exportToWkt(&wkt), OGRERR_NONE);
  CrsFacts facts = crs_facts(std::string(wkt));
  CPLFree(wkt);
  return facts;
}

TEST(Globe, RefusesATerrainThatHoldsAPole) {
  for (const int epsg : {3031, 3413}) {
    const CrsFacts crs = facts_of(epsg);
    // In the middle, beside it, on a side, in a corner.
    for (const auto& [west, south] : {std::pair(-48000.0, -48000.0),
                                      {-10000.0, -70000.0},
                                      {-48000.0, 0.0},
                                      {-96000.0, -96000.0}}) {
      const StoreFacts facts = polar_facts(west, south);
      EXPECT_EQ(code_of([&] { const Globe globe(facts, crs); }), ErrorCode::invalid_argument)
          << epsg << " " << west << " " << south;
    }
    EXPECT_EQ(code_of([&] { const Globe globe(polar_facts(500.0, -48000.0), crs); }),
              ErrorCode::internal);  // No error at all.
  }
}

TEST(Globe, HoldsItsTerrainInItsBox) {
  // A pole hardly beside a terrain lets latitude bend sharply; a wide terrain bends everywhere.
  StoreFacts wide = polar_facts(-300000.0, 5000000.0);
  wide.map.step_x = wide.map.step_y = 100.0;
  for (const auto& [epsg, facts] : {std::pair(3031, polar_facts(100.0, -40123.0)),
                                    {3413, polar_facts(-48000.0, 20.0)},
                                    {3413, polar_facts(-1200000.0, 1100000.0)},
                                    {32633, wide},
                                    {3035, wide}}) {
    const Globe globe(facts, facts_of(epsg));
    const GlobeBox& box = globe.box();
    const auto path = globe.path();
    GlobeBox seen{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    const GridBox& b = facts.bounds;
    for (int i = 0; i <= 4 * b.max_x; ++i) {
      const int side = i / (b.max_x + 1);
      const double t = i % (b.max_x + 1);
      const double x = side == 0 ? 0 : side == 1 ? b.max_x : t;
      const double y = side < 2 ? t : side == 2 ? 0 : b.max_y;
      const GlobePoint p = path->to_globe(x, y, 0.0);
      seen = {std::min(seen.west, p.lon), std::min(seen.south, p.lat), std::max(seen.east, p.lon),
              std::max(seen.north, p.lat)};
    }
    EXPECT_LE(box.west, seen.west) << epsg;
    EXPECT_LE(box.south, seen.south) << epsg;
    EXPECT_GE(box.east, seen.east) << epsg;
    EXPECT_GE(box.north, seen.north) << epsg;
    EXPECT_LT(box.north - box.south, 1.05 * (seen.north - seen.south)) << epsg;
    const bool is_at_pole = std::max(-seen.south, seen.north) > 89.9;  // There it turns about.
    EXPECT_LE(box.east - box.west,
              is_at_pole ? 360.0 * (1 + 1e-11) : 1.05 * (seen.east - seen.west))
        << epsg;
  }
}

}  // namespace
}  // namespace ptin::tools::testing
