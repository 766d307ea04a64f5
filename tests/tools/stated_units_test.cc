// SPDX-License-Identifier: GPL-3.0-or-later
//
// Facts that a format has fields for: units, CRS, vertical CRS; read back by GDAL, or from
// the text of the file.
#include <map>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::expect_done;
using testing::hills;
using testing::make_raster;
using testing::RasterRecipe;
using testing::read_file;
using testing::TestFolder;

class StatedUnits : public ::testing::Test {
 protected:
  /// Hills in a CRS, whose height unit is that of its vertical part.
  void build(const std::string& crs) {
    RasterRecipe recipe;
    recipe.value = [](int x, int y) { return hills(x, y); };
    make_raster(folder_.file("s.tif"), recipe);
    std::vector<std::string> all = {"build", folder_.file("s.tif"), "-o",
                                    store_,  "--overwrite",         "-q"};
    if (!crs.empty()) all.insert(all.end(), {"--a-srs", crs});
    expect_done(all);
  }
  std::string written(const std::string& subcommand, const std::string& name,
                      const std::vector<std::string>& more = {}) {
    std::vector<std::string> all = {subcommand,         store_,        "-o",
                                    folder_.file(name), "--overwrite", "-q"};
    all.insert(all.end(), more.begin(), more.end());
    expect_done(all);
    return folder_.file(name);
  }
  TestFolder folder_;
  std::string store_ = folder_.file("s.ptin");
};

/// The value of a variable in the header of a DXF file; empty where it has none.
std::string dxf_variable(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(name + "\n");
  if (at == std::string::npos) return "";
  const std::size_t code = text.find('\n', at) + 1, value = text.find('\n', code) + 1;
  const std::string line = text.substr(value, text.find('\n', value) - value);
  return line.substr(line.find_first_not_of(' '));
}

TEST_F(StatedUnits, DrawingsStateTheUnitOfThePlane) {
  struct Drawing {
    const char *crs, *insunits, *measurement;
  };
  for (const Drawing& c : std::vector<Drawing>{{"EPSG:32611", "6", "1"},
                                               {"EPSG:2225", "21", "0"},    // US survey feet
                                               {"EPSG:2222", "2", "0"}}) {  // feet
    SCOPED_TRACE(c.crs);
    build(c.crs);
    for (const std::string& path : {written("isoline", "l.dxf", {"--interval", "20"}),
                                    written("refine", "m.dxf"), written("export", "e.dxf")}) {
      const std::string text = read_file(path);
      EXPECT_EQ(dxf_variable(text, "$INSUNITS"), c.insunits) << path;
      EXPECT_EQ(dxf_variable(text, "$MEASUREMENT"), c.measurement) << path;
    }
  }
}

void expect_crs(const OGRSpatialReference* srs, const std::string& name) {
  ASSERT_NE(srs, nullptr) << name;
  EXPECT_NE(srs->IsCompound(), 0) << name;
  const char* unit = nullptr;
  srs->GetTargetLinearUnits("COMPD_CS|VERT_CS", &unit);
  EXPECT_STREQ(unit, "US survey foot") << name;
}

TEST_F(StatedUnits, RastersStateCrsVerticalPartUnitAndNodata) {
  build("EPSG:32611+6360");
  GDALAllRegister();
  const std::map<std::string, std::vector<std::string>> outputs = {
      {"e.tif", {}}, {"c.tif", {"--format", "COG"}}, {"s.tif", {"--what", "slope"}}};
  for (const auto& [name, more] : outputs) {
    const std::string path = written("export", "x" + name, more);
    const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str()));
    ASSERT_TRUE(data);
    expect_crs(data->GetSpatialRef(), name);
    int has_nodata = 0;
    data->GetRasterBand(1)->GetNoDataValue(&has_nodata);
    EXPECT_NE(has_nodata, 0) << name;
    EXPECT_STREQ(data->GetRasterBand(1)->GetUnitType(),
                 name == "s.tif" ? "degree" : "US survey foot")
        << name;
  }
}

TEST_F(StatedUnits, LayersStateCrsAndVerticalPart) {
  build("EPSG:32611+6360");
  GDALAllRegister();
  for (const char* name : {"l.gpkg", "l.fgb", "l.shp"}) {
    const std::string path = written("isoline", name, {"--interval", "20"});
    const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
    ASSERT_TRUE(data) << name;
    const OGRSpatialReference* srs = data->GetLayer(0)->GetSpatialRef();
    ASSERT_NE(srs, nullptr) << name;
    EXPECT_NE(std::string(srs->GetName()).find("UTM zone 11N"), std::string::npos)
        << name << srs->GetName();
  }
}

TEST_F(StatedUnits, ViewshedsStateCrsAndVerticalPart) {
  build("EPSG:32611+6360");
  GDALAllRegister();
  const std::vector<std::string> from = {"500100", "3999900", "2", "--radius", "300"};
  const auto seen = [&](const std::string& name) {
    std::vector<std::string> all = {"viewshed", store_};
    all.insert(all.end(), from.begin(), from.end());
    all.insert(all.end(), {"-o", folder_.file(name), "--overwrite", "-q"});
    expect_done(all);
    return GDALDatasetUniquePtr(
        GDALDataset::Open(folder_.file(name).c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR));
  };
  const auto raster = seen("v.tif");
  ASSERT_TRUE(raster);
  expect_crs(raster->GetSpatialRef(), "v.tif");
  const auto vertices = seen("v.gpkg");
  ASSERT_TRUE(vertices);
  ASSERT_NE(vertices->GetLayer(0)->GetSpatialRef(), nullptr);
  EXPECT_NE(std::string(vertices->GetLayer(0)->GetSpatialRef()->GetName()).find("UTM zone 11N"),
            std::string::npos);
}

TEST_F(StatedUnits, GlbsStateTheUnitOfHeights) {
  build("EPSG:32611+6360");
  EXPECT_NE(read_file(written("refine", "u.glb")).find("\"height_unit\":\"US survey foot\""),
            std::string::npos);
}

TEST_F(StatedUnits, MeshesNameTheCrsInTheirOwnWay) {
  build("EPSG:32611+6360");
  for (const char* name : {"m.ply", "m.xml", "m.dxf", "m.glb"}) {
    const std::string text = read_file(written("refine", name));
    EXPECT_NE(text.find("32611"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace ptin::tools
