// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/crs.h"

#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "engine/error.h"

namespace ptin {
namespace {

void expect_crs_refused(const std::string& declared, const std::string& a_srs,
                        const std::string& vertical_crs, const std::string& word) {
  try {
    std::ignore = resolve_crs(declared, a_srs, vertical_crs);
    FAIL() << "accepted " << declared << a_srs << vertical_crs;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  }
}

TEST(Crs, IsUnknownWhereNothingIsDeclared) {
  const Crs crs = resolve_crs("", "", "");
  EXPECT_EQ(crs.wkt, "");
  EXPECT_EQ(crs.horizontal_unit, "unknown");
  EXPECT_EQ(crs.vertical_unit, "unknown");
  EXPECT_FALSE(crs.vertical_known);
}

TEST(Crs, IsWrittenAsWkt2OnOneLine) {
  const Crs crs = resolve_crs("EPSG:32611", "", "");
  EXPECT_EQ(crs.wkt.rfind("PROJCRS[\"WGS 84 / UTM zone 11N\"", 0), 0U) << crs.wkt;
  EXPECT_EQ(crs.wkt.find('\n'), std::string::npos);
  EXPECT_EQ(crs.horizontal_unit, "metre");
  EXPECT_FALSE(crs.geographic);
  EXPECT_FALSE(crs.vertical_known);
}

TEST(Crs, KnowsDegreesAndFeet) {
  const Crs degrees = resolve_crs("EPSG:4326", "", "");
  EXPECT_TRUE(degrees.geographic);
  EXPECT_EQ(degrees.horizontal_unit, "degree");
  EXPECT_EQ(resolve_crs("EPSG:2994", "", "").horizontal_unit, "foot");
  EXPECT_EQ(resolve_crs("EPSG:2263", "", "").horizontal_unit, "US survey foot");
}

TEST(Crs, OfTheCallerTakesThePlaceOfTheDeclaredOne) {
  const Crs crs = resolve_crs("EPSG:4326+5773", "EPSG:32611", "");
  EXPECT_NE(crs.wkt.find("UTM zone 11N"), std::string::npos);
  EXPECT_FALSE(crs.vertical_known);
}

TEST(Crs, IsKeptCompoundWhereItIsDeclaredSo) {
  const Crs crs = resolve_crs("EPSG:4326+5773", "", "");
  EXPECT_TRUE(crs.vertical_known);
  EXPECT_TRUE(crs.geographic);
  EXPECT_EQ(crs.vertical_unit, "metre");
  EXPECT_EQ(crs.wkt.rfind("COMPOUNDCRS[", 0), 0U) << crs.wkt;
  EXPECT_TRUE(is_same_crs(crs.wkt, resolve_crs(crs.wkt, "", "").wkt));
}

TEST(Crs, GetsAVerticalPart) {
  const Crs crs = resolve_crs("EPSG:32611", "", "EPSG:6360");  // NAVD88 height (ftUS)
  EXPECT_TRUE(crs.vertical_known);
  EXPECT_EQ(crs.vertical_unit, "US survey foot");
  EXPECT_EQ(crs.horizontal_unit, "metre");
  EXPECT_EQ(crs.wkt.rfind("COMPOUNDCRS[", 0), 0U) << crs.wkt;
}

TEST(Crs, ReplacesTheVerticalPartThatItHas) {
  for (const char* declared : {"EPSG:4326+5773", "EPSG:4979"}) {
    const Crs crs = resolve_crs(declared, "", "EPSG:3855");
    EXPECT_NE(crs.wkt.find("EGM2008"), std::string::npos) << crs.wkt;
    EXPECT_EQ(crs.wkt.find("EGM96"), std::string::npos) << crs.wkt;
    EXPECT_TRUE(crs.vertical_known);
    EXPECT_TRUE(crs.geographic);
  }
}

TEST(Crs, CountsEllipsoidalHeightsAsVertical) {
  const Crs crs = resolve_crs("EPSG:4979", "", "");
  EXPECT_TRUE(crs.vertical_known);
  EXPECT_EQ(crs.vertical_unit, "metre");
}

TEST(Crs, IsRefusedWithWhatGdalSaysWhereItIsNotUnderstood) {
  expect_crs_refused("", "EPSG:999999", "", "not one that GDAL understands");
  expect_crs_refused("", "the moon", "", "the moon");
  expect_crs_refused("PROJCRS[nonsense", "", "", "source's CRS");
  expect_crs_refused("EPSG:4326", "", "gibberish", "vertical CRS 'gibberish'");
}

TEST(Crs, IsRefusedWhereItIsNoHorizontalOne) {
  expect_crs_refused("", "EPSG:5773", "", "vertical CRS alone");
  expect_crs_refused("", "EPSG:4978", "", "neither geographic nor projected");  // geocentric
}

TEST(Crs, RefusesAVerticalPartThatIsNone) {
  expect_crs_refused("EPSG:4326", "", "EPSG:32611", "is not a vertical CRS");
  expect_crs_refused("EPSG:4326", "", "EPSG:4326+5773", "is not a vertical CRS");
  expect_crs_refused("", "", "EPSG:5773", "no horizontal CRS");
}

// EPSG:4326 given by mistake over metres: distances and voids would be nonsense without a word.
TEST(Crs, OfDegreesIsRefusedOverMetres) {
  TerrainFrame frame;
  set_crs(frame, resolve_crs("EPSG:4326", "", ""));
  frame.map = {376328, 3806732, 30, 30};
  try {
    require_latitudes(frame, 100, "a.tif");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find("--a-srs"), std::string::npos) << e.message();
  }
  frame.map = {-180, -90, 0.5, 0.5};
  EXPECT_NO_THROW(require_latitudes(frame, 360, ""));
  EXPECT_THROW(require_latitudes(frame, 366, ""), Error);
  set_crs(frame, resolve_crs("EPSG:32611", "", ""));
  frame.map = {376328, 3806732, 30, 30};
  EXPECT_NO_THROW(require_latitudes(frame, 100, ""));
}

TEST(IsSameCrs, ComparesMeaningAndNotText) {
  const std::string utm = resolve_crs("EPSG:32611", "", "").wkt;
  EXPECT_TRUE(is_same_crs("", ""));
  EXPECT_TRUE(is_same_crs(utm, "EPSG:32611"));
  EXPECT_FALSE(is_same_crs(utm, "EPSG:32612"));
  EXPECT_FALSE(is_same_crs(utm, ""));
}

TerrainFrame frame_of(const std::string& crs, const AffineMap& map) {
  TerrainFrame frame;
  set_crs(frame, resolve_crs(crs, "", ""));
  frame.map = map;
  return frame;
}

TEST(GroundMetric, IsThatOfTheMapWhereTheCrsIsProjected) {
  const GroundMetric metric(frame_of("EPSG:32611", {500, 700, 30, 25}));
  EXPECT_TRUE(metric.is_uniform());
  EXPECT_EQ(metric.at(17), (GroundStep{30, 25}));
}

// Lengths of a degree on WGS 84, as published (NGA): latitude, of longitude, of latitude, metres.
TEST(GroundMetric, IsInMetresAtTheRowWhereTheCrsIsGeographic) {
  const GroundMetric metric(frame_of("EPSG:4326", {0, -90, 1, 1}));
  EXPECT_FALSE(metric.is_uniform());
  struct Length {
    double latitude, x, y;
  };
  for (const Length& l :
       {Length{0, 111319.5, 110574.3}, Length{30, 96486.3, 110852.4}, Length{45, 78846.8, 111131.7},
        Length{60, 55800.0, 111412.2}, Length{-60, 55800.0, 111412.2}}) {
    EXPECT_NEAR(metric.at(90 + l.latitude).x, l.x, 1.0) << l.latitude;
    EXPECT_NEAR(metric.at(90 + l.latitude).y, l.y, 1.0) << l.latitude;
  }
  EXPECT_NEAR(metric.at(180).x, 0, 1e-9);
  EXPECT_GE(metric.at(180.5).x, 0) << "rows beyond a pole are not negative";
}

TEST(GroundMetric, CountsOtherAngularUnits) {
  const GroundMetric grads(frame_of("EPSG:4807", {0, 0, 1, 1}));  // NTF (Paris), grads
  EXPECT_NEAR(grads.at(0).x, 111320 * 0.9, 40);
}

}  // namespace
}  // namespace ptin
