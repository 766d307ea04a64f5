// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/crs_facts.h"

#include <gtest/gtest.h>
#include <ogr_spatialref.h>

namespace ptin::tools {
namespace {

std::string wkt2_of(const OGRSpatialReference& srs) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  srs.exportToWkt(&text, options);
  std::string wkt(text);
  CPLFree(text);
  return wkt;
}

CrsFacts facts_of(const char* code) {
  OGRSpatialReference srs;
  EXPECT_EQ(srs.SetFromUserInput(code), OGRERR_NONE) << code;
  return crs_facts(wkt2_of(srs));
}

std::string utm_3d() {
  OGRSpatialReference srs;
  EXPECT_EQ(srs.importFromEPSG(32617), OGRERR_NONE);
  EXPECT_EQ(srs.PromoteTo3D(nullptr), OGRERR_NONE);
  return wkt2_of(srs);
}

TEST(CrsFacts, KnowHeightsAboveTheEllipsoidInEveryKindOfCrs) {
  const CrsFacts world = facts_of("EPSG:4979");
  EXPECT_TRUE(world.has_third_axis);
  EXPECT_EQ(world.vertical_name, "ellipsoidal height");
  EXPECT_EQ(world.code, "EPSG:4979");
  EXPECT_EQ(world.vertical_unit, "metre");
  const CrsFacts utm = crs_facts(utm_3d());
  EXPECT_TRUE(utm.has_third_axis);
  EXPECT_EQ(utm.vertical_name, "ellipsoidal height");
  EXPECT_EQ(utm.name, "WGS 84 / UTM zone 17N");
  EXPECT_FALSE(facts_of("EPSG:4326+5773").has_third_axis);
  EXPECT_FALSE(facts_of("EPSG:32617").has_third_axis);
}

TEST(CrsFacts, TakeTheUnitOfEllipsoidalHeightsFromTheirOwnAxis) {
  const CrsFacts feet = crs_facts(
      "PROJCRS[\"p\",BASEGEOGCRS[\"WGS 84\",DATUM[\"World Geodetic System 1984\","
      "ELLIPSOID[\"WGS 84\",6378137,298.257223563]]],CONVERSION[\"UTM zone 32N\","
      "METHOD[\"Transverse Mercator\",ID[\"EPSG\",9807]],"
      "PARAMETER[\"Longitude of natural origin\",9,ANGLEUNIT[\"degree\",0.0174532925199433]],"
      "PARAMETER[\"Scale factor at natural origin\",0.9996,SCALEUNIT[\"unity\",1]]],"
      "CS[Cartesian,3],AXIS[\"(E)\",east,LENGTHUNIT[\"metre\",1]],"
      "AXIS[\"(N)\",north,LENGTHUNIT[\"metre\",1]],"
      "AXIS[\"h\",up,LENGTHUNIT[\"foot\",0.3048]]]");
  EXPECT_TRUE(feet.has_third_axis);
  EXPECT_EQ(feet.horizontal_unit, "metre");
  EXPECT_EQ(feet.vertical_unit, "foot");
}

// A header that names the plane alone would lose where heights count from, and a vertical CRS of three
// axes is none that a reader understands.
TEST(CrsFacts, NameEllipsoidalHeightsInTheOneTextOfTheCrs) {
  EXPECT_EQ(facts_of("EPSG:4979").horizontal_text(), "EPSG:4979");
  EXPECT_EQ(facts_of("EPSG:4979").vertical_text(), "");
  const CrsFacts utm = crs_facts(utm_3d());
  EXPECT_EQ(utm.horizontal_text(), utm.wkt);
  EXPECT_EQ(utm.vertical_text(), "");
}

TEST(CrsFacts, AreOfTheSamePlaneWhereOneOfThemHasHeights) {
  EXPECT_TRUE(is_same_plane(facts_of("EPSG:4979"), facts_of("EPSG:4326")));
  EXPECT_TRUE(is_same_plane(crs_facts(utm_3d()), facts_of("EPSG:32617")));
  EXPECT_TRUE(is_same_plane(crs_facts(utm_3d()), facts_of("EPSG:32617+5773")));
  EXPECT_FALSE(is_same_plane(crs_facts(utm_3d()), facts_of("EPSG:32618")));
}

}  // namespace
}  // namespace ptin::tools
