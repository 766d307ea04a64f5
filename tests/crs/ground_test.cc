// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/ground.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

namespace ptin::tools {
namespace {

std::string wkt_of(const char* code) {
  OGRSpatialReference srs;
  EXPECT_EQ(srs.SetFromUserInput(code), OGRERR_NONE) << code;
  char* text = nullptr;
  srs.exportToWkt(&text);
  std::string wkt(text);
  CPLFree(text);
  return wkt;
}

CrsFacts facts_of(const char* code, const std::string& unit_of_heights) {
  CrsFacts facts = crs_facts(wkt_of(code));
  if (facts.vertical_unit == "unknown") facts.vertical_unit = unit_of_heights;
  return facts;
}

constexpr double kSurveyFoot = 1200.0 / 3937.0;

TEST(Ground, TakesHeightsOfNoKnownUnitToBeInThatOfThePlane) {
  const Ground feet = ground_of(facts_of("EPSG:2225", "unknown"));  // California, US survey feet
  EXPECT_DOUBLE_EQ(feet.metres_per_height, kSurveyFoot);
  EXPECT_DOUBLE_EQ(feet.distance({0, 0}, {300, 400}), 500);
  const Ground metres = ground_of(facts_of("EPSG:32610", "unknown"));
  EXPECT_EQ(metres.metres_per_height, 1);
  EXPECT_EQ(ground_of(facts_of("EPSG:4326", "unknown")).metres_per_height, 1);
  EXPECT_EQ(ground_of(CrsFacts{}).metres_per_height, 1);
}

TEST(Ground, TakesTheUnitOfHeightsThatTheSourceTells) {
  const Ground metres = ground_of(facts_of("EPSG:2225", "metre"));
  EXPECT_NEAR(metres.distance({0, 0}, {300, 400}), 500 * kSurveyFoot, 1e-9);
  EXPECT_EQ(ground_of(facts_of("EPSG:32610", "foot")).metres_per_height, 0.3048);
}

TEST(MetresPerMapUnit, IsThatOfThePlaneOrOfTheEllipsoidHere) {
  const auto feet = metres_per_map_unit(facts_of("EPSG:2225", "metre"), {6e6, 2e6});
  ASSERT_TRUE(feet);
  EXPECT_DOUBLE_EQ(feet->x, kSurveyFoot);
  EXPECT_DOUBLE_EQ(feet->y, kSurveyFoot);
  const auto degrees = metres_per_map_unit(facts_of("EPSG:4326", "foot"), {9, 60});
  ASSERT_TRUE(degrees);
  EXPECT_NEAR(degrees->x, 55800, 1);
  EXPECT_NEAR(degrees->y, 111412, 1);
}

TEST(MetresPerMapUnit, IsNotGuessed) {
  EXPECT_FALSE(metres_per_map_unit(CrsFacts{}, {0, 0}));
  CrsFacts named;
  named.horizontal_unit = "foot";
  EXPECT_EQ(metres_per_map_unit(named, {0, 0})->x, 0.3048);
}

TEST(Ground, TakesThePlanesUnitThatTheSourceTellsWithoutACrs) {
  CrsFacts crs;
  crs.horizontal_unit = crs.vertical_unit = "foot";
  const Ground feet = ground_of(crs);
  EXPECT_EQ(feet.metres_per_height, 0.3048);
  EXPECT_DOUBLE_EQ(feet.distance({0, 0}, {300, 400}), 500);
  EXPECT_DOUBLE_EQ(feet.earth_diameter, 2 * 6378137.0 / 0.3048);
  crs.vertical_unit = "metre";
  EXPECT_DOUBLE_EQ(ground_of(crs).distance({0, 0}, {300, 400}), 500 * 0.3048);
}

TEST(Ground, TakesTheVerticalCrsBeforeAnythingElse) {
  const Ground feet = ground_of(facts_of("EPSG:32610+6360", "metre"));  // NAVD88, US survey feet
  EXPECT_DOUBLE_EQ(feet.metres_per_height, kSurveyFoot);
  EXPECT_NEAR(feet.distance({0, 0}, {300, 400}), 500 / kSurveyFoot, 1e-9);
}

}  // namespace
}  // namespace ptin::tools
