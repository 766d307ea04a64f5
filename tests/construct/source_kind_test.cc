// SPDX-License-Identifier: GPL-3.0-or-later
//
// What kind of source a build reads, and that options which mean nothing to it are refused by the
// library and not by the program alone.
#include "engine/construct/source_kind.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/error.h"
#include "tests/construct/made_raster.h"

namespace ptin {
namespace {

class SourceKindOf : public ::testing::Test {
 protected:
  SourceKindOf() {
    oracle::write_text(points_, "0 0 1\n10 0 2\n0 10 3\n10 10 4\n");
    oracle::write_text(tin_, "v 0 0 1\nv 10 0 2\nv 0 10 3\nf 1 2 3\n");
  }
  static std::string refusal(const std::vector<std::string>& inputs, const BuildOptions& options) {
    try {
      static_cast<void>(source_kind(inputs, options));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      return e.message();
    }
    return "";
  }

  oracle::ScratchFolder folder_;
  std::string raster_ = PTIN_TEST_DATA "/coast_257.tif";
  std::string points_ = folder_.file("a.xyz"), tin_ = folder_.file("a.obj");
};

TEST_F(SourceKindOf, InputsIsTheOneOfAllOfThem) {
  EXPECT_EQ(source_kind({raster_}, {}), InputKind::kRaster);
  EXPECT_EQ(source_kind({points_, points_}, {}), InputKind::kPoints);
  EXPECT_EQ(source_kind({tin_}, {}), InputKind::kTin);
  BuildOptions repair;
  repair.repair = true;
  EXPECT_EQ(source_kind({tin_, tin_}, repair), InputKind::kPoints);
  EXPECT_NE(refusal({}, {}).find("no input"), std::string::npos);
  EXPECT_NE(refusal({raster_, points_}, {}).find("rasters and points together"), std::string::npos);
  EXPECT_NE(refusal({tin_, tin_}, {}).find("build a TIN alone"), std::string::npos);
  EXPECT_NE(refusal({raster_, tin_}, {}).find("build a TIN alone"), std::string::npos);
}

TEST_F(SourceKindOf, InputsRefusesOptionsThatWouldBeIgnored) {
  BuildOptions resolution, classes, repair, max_edge, z_field, layer, columns, skip_invalid;
  resolution.resolution = 1.0;
  classes.classes = {2};
  repair.repair = true;
  max_edge.max_edge = 5.0;
  z_field.z_field = "height";
  layer.layer = "spots";
  columns.columns = {"x", "y", "z"};
  skip_invalid.skip_invalid = true;
  for (const BuildOptions& options :
       {resolution, classes, repair, max_edge, columns, skip_invalid}) {
    EXPECT_NE(refusal({raster_}, options).find("leave it out"), std::string::npos);
  }
  EXPECT_NE(refusal({points_}, repair).find("--repair is for TINs"), std::string::npos);
  for (const BuildOptions& options : {classes, z_field, layer, max_edge, columns, skip_invalid}) {
    EXPECT_NE(refusal({tin_}, options).find("leave it out"), std::string::npos);
  }
  // One that is not there is told of when it is opened.
  EXPECT_EQ(refusal({folder_.file("no.tif")}, resolution), "");
}

TEST_F(SourceKindOf, AStoreIsRefusedByItsFirstBytes) {
  const std::string store = folder_.file("a.ptin"), renamed = folder_.file("a.tif");
  build({raster_}, store, {}, {});
  std::filesystem::copy(store, renamed);
  BuildOptions layer;
  layer.layer = "triangles";
  for (const BuildOptions& options : {BuildOptions{}, layer}) {
    for (const std::string& input : {store, renamed}) {
      EXPECT_NE(refusal({input}, options).find("a store, not a source"), std::string::npos);
    }
  }
  EXPECT_NE(refusal({raster_, store}, {}).find("a store, not a source"), std::string::npos);
  // Fewer bytes than a store begins with are none.
  oracle::write_text(folder_.file("cut.tif"), "\x89PTIN");
  EXPECT_EQ(source_kind({folder_.file("cut.tif")}, {}), InputKind::kRaster);
}

TEST_F(SourceKindOf, ABuildIsAskedBeforeAnythingIsWritten) {
  BuildOptions classes;
  classes.classes = {2};
  try {
    build({raster_}, folder_.file("out.ptin"), classes, {});
    FAIL() << "a raster has no classes";
  } catch (const Error& e) {
    EXPECT_EQ(e.message(), "--class is for LAS, and this is a raster; leave it out");
    EXPECT_EQ(e.context(), raster_);
  }
  EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.obj", "a.xyz"}));
}

}  // namespace
}  // namespace ptin
