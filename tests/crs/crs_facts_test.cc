// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/crs/crs_facts.h"

#include <array>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "engine/crs/ground.h"

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

/// Of every kind: degrees and gon, metres and feet, axes to the north first, heights of each sort.
constexpr std::array kKinds = {"EPSG:4326",      "EPSG:32617",     "EPSG:2225",      "EPSG:4979",
                               "EPSG:4326+5773", "EPSG:2225+6360", "EPSG:3413",      "EPSG:31467",
                               "EPSG:4807",      "EPSG:2193+7839", "EPSG:27700+5701"};

nlohmann::json metadata_with(const CrsFacts& crs, bool has_facts) {
  nlohmann::json metadata = {{"crs", {{"wkt", crs.wkt}}}, {"units", {{"height", "foot"}}}};
  if (has_facts) metadata["crs"]["facts"] = json_of(crs);
  return nlohmann::json::parse(metadata.dump());
}

TEST(CrsFacts, ThatStandBesideTheTextAreThoseOfTheText) {
  for (const char* code : kKinds) {
    const CrsFacts crs = facts_of(code);
    ASSERT_TRUE(crs.is_understood) << code;
    const CrsFacts read = crs_facts_of(metadata_with(crs, false));
    const std::uint64_t before = crs_texts_read();
    const CrsFacts told = crs_facts_of(metadata_with(crs, true));
    EXPECT_EQ(crs_texts_read(), before) << code;
    EXPECT_EQ(told.wkt, read.wkt);
    EXPECT_EQ(json_of(told), json_of(read)) << code;
    EXPECT_EQ(told.geographic, read.geographic) << code;
    EXPECT_EQ(told.vertical_unit, read.vertical_unit) << code;
    EXPECT_EQ(unit_of_ground(told), unit_of_ground(read)) << code;
    EXPECT_EQ(json_of(ground_facts_of(told)), json_of(ground_facts_of(read))) << code;
    EXPECT_TRUE(is_same_plane(told, read)) << code;
  }
}

TEST(CrsFacts, AreReadWhereThoseBesideTheTextMeanNothing) {
  const CrsFacts crs = facts_of("EPSG:4326+5773");
  const nlohmann::json sound = json_of(crs);
  const auto is_read = [&](const nlohmann::json& facts) {
    nlohmann::json metadata = metadata_with(crs, false);
    metadata["crs"]["facts"] = facts;
    const std::uint64_t before = crs_texts_read();
    EXPECT_EQ(crs_facts_of(metadata).name, "WGS 84");
    return crs_texts_read() > before;
  };
  EXPECT_FALSE(is_read(sound));
  for (const nlohmann::json& facts :
       {nlohmann::json(), nlohmann::json(5), nlohmann::json::array(), nlohmann::json::object()}) {
    EXPECT_TRUE(is_read(facts)) << facts;
  }
  for (const auto& member : sound.items()) {
    nlohmann::json facts = sound;
    facts.erase(member.key());
    EXPECT_TRUE(is_read(facts)) << member.key();
    facts[member.key()] = {1, 2};
    EXPECT_TRUE(is_read(facts)) << member.key();
  }
  for (const auto& member : sound["ground"].items()) {
    nlohmann::json facts = sound;
    facts["ground"][member.key()] = -1;
    EXPECT_TRUE(is_read(facts)) << member.key();
  }
}

TEST(CrsFacts, OfATextThatIsNotUnderstoodDoNotStandBesideIt) {
  EXPECT_TRUE(json_of(crs_facts("this is no CRS")).is_null());
  EXPECT_TRUE(json_of(CrsFacts{}).is_null());
}

}  // namespace
}  // namespace ptin::tools
