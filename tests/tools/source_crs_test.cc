// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which CRS a source's declarations come to, beyond that they are heard (declarations/).
#include <array>
#include <cstdint>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/las_file.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

class SourceCrs : public ::testing::Test {
 protected:
  Outcome build(const std::string& source, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> all = {"build", source, "-o", folder_.file("t.ptin"), "--overwrite"};
    all.insert(all.end(), options.begin(), options.end());
    Outcome made = run_ptin(all);
    EXPECT_EQ(made.status, 0) << made.err;
    return made;
  }
  [[nodiscard]] json info() const {
    return json::parse(run_ptin({"info", folder_.file("t.ptin"), "--json"}).out);
  }
  [[nodiscard]] std::string grid(const std::string& prj) const {
    write_file(folder_.file("g.asc"),
               "ncols 2\nnrows 2\nxllcorner 500000\nyllcorner 4000000\ncellsize 30\n1 2\n3 5\n");
    write_file(folder_.file("g.prj"), prj);
    return folder_.file("g.asc");
  }
  [[nodiscard]] std::string las(const std::vector<std::array<std::uint16_t, 4>>& entries) const {
    LasFileMaker las;
    for (int i = 0; i < 9; ++i) las.points.push_back({1000 * (i % 3), 1000 * (i / 3), 100 * i});
    std::vector<std::uint16_t> words = {1, 1, 0, static_cast<std::uint16_t>(entries.size())};
    for (const auto& e : entries) words.insert(words.end(), e.begin(), e.end());
    las.records = {{34735, {reinterpret_cast<const char*>(words.data()), words.size() * 2}}};
    write_file(folder_.file("p.las"), las.bytes());
    return folder_.file("p.las");
  }
  TestFolder folder_;
};

TEST_F(SourceCrs, OfAGmlHasItsVerticalPart) {
  std::string text =
      R"(<?xml version="1.0"?><ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/" )"
      R"(xmlns:gml="http://www.opengis.net/gml/3.2">)";
  for (const char* corner : {"0 0", "0 100", "100 100", "100 0"}) {
    text +=
        std::string(R"(<gml:featureMember><ogr:t gml:id="t"><ogr:geom><gml:Point gml:id="p" )") +
        R"(srsName="urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837" srsDimension="3"><gml:pos>)" +
        corner + " 7</gml:pos></gml:Point></ogr:geom></ogr:t></gml:featureMember>";
  }
  write_file(folder_.file("p.gml"), text + "</ogr:FeatureCollection>");
  build(folder_.file("p.gml"));
  EXPECT_EQ(info()["crs"]["vertical_code"], "EPSG:7837");
  EXPECT_EQ(info()["units"]["height"], "metre");
}

TEST_F(SourceCrs, IsThatOfTheCodeWhereKeysTellNoModel) {
  build(las({{1024, 0, 1, 0}, {3072, 0, 1, 32611}}));
  EXPECT_EQ(info()["crs"]["code"], "EPSG:32611");
}

TEST_F(SourceCrs, OfAnUnknownCodeHasNoUnit) {
  build(las({{1024, 0, 1, 1}, {3072, 0, 1, 29999}}));
  EXPECT_TRUE(info()["crs"]["wkt"].is_null());
  EXPECT_EQ(info()["units"]["horizontal"], "unknown");
}

TEST_F(SourceCrs, IsNotAskedForWhereItIsGiven) {
  const std::string source = grid("not a projection");
  EXPECT_NE(build(source).err.find("is not one that GDAL understands"), std::string::npos);
  EXPECT_EQ(build(source, {"--a-srs", "EPSG:32611"}).err.find("warning: "), std::string::npos);
  EXPECT_EQ(info()["crs"]["code"], "EPSG:32611");
}

TEST_F(SourceCrs, OfHeightsAnswersForAnUnknownUnit) {
  testing::RasterRecipe recipe;
  recipe.value = testing::hills;
  recipe.unit = "m above NAVD88";
  testing::make_raster(folder_.file("r.tif"), recipe);
  EXPECT_NE(build(folder_.file("r.tif")).err.find("none that is known"), std::string::npos);
  const Outcome told = build(folder_.file("r.tif"), {"--vertical-crs", "EPSG:5703"});
  EXPECT_EQ(told.err.find("warning: "), std::string::npos) << told.err;
}

TEST_F(SourceCrs, OfAnOldPrjTellsTheUnitOfHeights) {
  build(grid("Projection UTM\nZone 11\nDatum NAD27\nZunits FEET\nUnits METERS\nParameters\n"));
  EXPECT_EQ(info()["units"], json({{"horizontal", "metre"}, {"height", "foot"}}));
}

}  // namespace
}  // namespace ptin::tools
