// SPDX-License-Identifier: GPL-3.0-or-later
//
// CRSs and heights that meshes state are read again by `ptin build` as they were.
#include <cpl_conv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::hills;
using testing::make_raster;
using testing::RasterRecipe;
using testing::TestFolder;
using testing::write_file;

class WrittenCrs : public ::testing::Test {
 protected:
  /// A square of points, wherever the CRS has them.
  void build(const std::vector<std::string>& options, const std::string& head = "x,y,z\n") {
    write_file(folder_.file("p.csv"), head + "8,46,1\n8,47,2\n9,46,3\n9,47,4\n");
    std::vector<std::string> all = {"build", folder_.file("p.csv"), "-o", folder_.file("p.ptin"),
                                    "-q",    "--overwrite"};
    all.insert(all.end(), options.begin(), options.end());
    expect_done(all);
  }
  /// CRS and units of the terrain of this name.
  [[nodiscard]] json facts(const std::string& name) const {
    const json info = answer_of({"info", folder_.file(name), "--json"});
    json crs = info.at("crs");
    crs.erase("wkt");  // what a code stands for may differ from what was spelled out
    return {crs, info.at("units")};
  }
  /// Facts of a terrain that is built from a mesh of that of points.
  [[nodiscard]] json again(const std::string& extension, const std::string& subcommand) const {
    const std::string mesh = folder_.file("m" + extension);
    expect_done({subcommand, folder_.file("p.ptin"), "-o", mesh, "--overwrite", "-q"});
    expect_done({"build", mesh, "-o", folder_.file("m.ptin"), "-q", "--overwrite"});
    return facts("m.ptin");
  }
  void expect_the_same(const std::vector<std::string>& extensions) const {
    for (const std::string& extension : extensions) {
      for (const char* subcommand : {"refine", "export"}) {
        EXPECT_EQ(again(extension, subcommand), facts("p.ptin")) << subcommand << extension;
      }
    }
  }
  /// Facts of a terrain that is built from a GeoTIFF of that of a raster.
  [[nodiscard]] json raster_again() const {
    const std::string tiff = folder_.file("m.tif");
    expect_done({"export", folder_.file("p.ptin"), "-o", tiff, "--overwrite", "-q"});
    expect_done({"build", tiff, "-o", folder_.file("m.ptin"), "-q", "--overwrite"});
    return facts("m.ptin");
  }
  void expect_the_same_raster() const {
    const json before = facts("p.ptin"), after = raster_again();
    for (const char* const key : {"name", "vertical_known", "vertical_name", "geographic"})
      EXPECT_EQ(after[0].at(key), before[0].at(key)) << key;
    EXPECT_EQ(after[1], before[1]);
  }
  /// The WKT of a CRS with heights above its ellipsoid, in metres.
  [[nodiscard]] static std::string promoted(const char* code) {
    OGRSpatialReference srs;
    EXPECT_EQ(srs.SetFromUserInput(code), OGRERR_NONE);
    EXPECT_EQ(srs.PromoteTo3D(nullptr), OGRERR_NONE);
    char* text = nullptr;
    const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
    srs.exportToWkt(&text, options);
    std::string wkt = text;
    CPLFree(text);
    return wkt;
  }
  TestFolder folder_;
};

// A header that named the third axis as a vertical CRS would be refused by its own reader.
TEST_F(WrittenCrs, TellsHeightsAboveTheEllipsoid) {
  build({"--a-srs", "EPSG:4979"});
  EXPECT_EQ(facts("p.ptin")[0].at("vertical_name"), "ellipsoidal height");
  expect_the_same({".ply", ".obj"});
}

TEST_F(WrittenCrs, TellsTheUnitOfHeightsWhereNoVerticalCrsDoes) {
  build({"--a-srs", "EPSG:25832"}, "x,y,z[ft]\n");
  EXPECT_EQ(facts("p.ptin")[1].at("height"), "foot");
  expect_the_same({".ply", ".obj", ".xml"});
}

TEST_F(WrittenCrs, TellsTheUnitsWhereThereIsNoCrs) {
  build({}, "x[m],y[m],z[ft]\n");
  EXPECT_EQ(facts("p.ptin")[1], (json{{"horizontal", "metre"}, {"height", "foot"}}));
  expect_the_same({".ply", ".obj", ".xml"});
  build({}, "x[us-ft],y[us-ft],z[us-ft]\n");
  expect_the_same({".ply", ".obj"});
  build({}, "x,y,z\n");
  expect_the_same({".ply", ".obj"});
}

/// A raster, for which GeoTIFF has no form of its CRS of three axes but by codes.
TEST_F(WrittenCrs, OfAGeoTiffTellsHeightsAboveTheEllipsoid) {
  for (const char* const crs : {"EPSG:32632", "EPSG:25832"}) {
    const std::string solid = promoted(crs);
    RasterRecipe recipe;
    recipe.value = hills;
    make_raster(folder_.file("r.tif"), recipe);
    expect_done({"build", folder_.file("r.tif"), "--a-srs", solid, "-o", folder_.file("p.ptin"),
                 "-q", "--overwrite"});
    EXPECT_EQ(facts("p.ptin")[0].at("vertical_name"), "ellipsoidal height");
    expect_the_same_raster();
  }
}

/// EPSG has no code for heights above the ellipsoid of NAD83, so the plane alone is stated.
TEST_F(WrittenCrs, OfAGeoTiffIsAtLeastThatOfThePlane) {
  RasterRecipe recipe;
  recipe.value = hills;
  make_raster(folder_.file("r.tif"), recipe);
  expect_done({"build", folder_.file("r.tif"), "--a-srs", promoted("EPSG:2229"), "-o",
               folder_.file("p.ptin"), "-q", "--overwrite"});
  const json again = raster_again();
  EXPECT_EQ(again[0].at("code"), "EPSG:2229");
  EXPECT_EQ(again[1].at("horizontal"), "US survey foot");
  EXPECT_EQ(again[1].at("height"), "metre");
}

TEST_F(WrittenCrs, TellsTheVerticalCrs) {
  build({"--a-srs", "EPSG:25832+7837"});
  expect_the_same({".ply", ".obj", ".xml"});
}

}  // namespace
}  // namespace ptin::tools
