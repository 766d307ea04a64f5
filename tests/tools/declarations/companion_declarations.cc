// SPDX-License-Identifier: GPL-3.0-or-later
//
// Declarations in comments of points and TINs, and in a .prj beside a source.
#include "tests/support/las_file.h"
#include "tests/tools/declarations/declaration.h"

namespace ptin::tools::testing {

namespace {

const std::string kPointLines = "0 0 1\n9 0 2\n9 9 3\n0 9 4\n5 5 -9999\n6 6 -9999\n";
const std::string kObjTin = "v 0 0 1\nv 9 0 2\nv 9 9 3\nv 0 9 4\nf 1 2 3\nf 1 3 4\n";
const std::string kPlyTail =
    "element vertex 3\nproperty int x\nproperty int y\nproperty int z\nelement face 1\n"
    "property list uchar int vertex_index\nend_header\n0 0 1\n9 0 2\n9 9 3\n3 0 1 2\n";
/// As ESRI's programs write it.
const char* const kFeetPrj =
    R"(PROJCS["NAD_1983_StatePlane_California_V_FIPS_0405_Feet",)"
    R"(GEOGCS["GCS_North_American_1983",DATUM["D_North_American_1983",)"
    R"(SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],)"
    R"(UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],)"
    R"(PARAMETER["False_Easting",6561666.666666666],PARAMETER["False_Northing",1640416.666666667],)"
    R"(PARAMETER["Central_Meridian",-118.0],PARAMETER["Standard_Parallel_1",34.03333333333333],)"
    R"(PARAMETER["Standard_Parallel_2",35.46666666666667],PARAMETER["Latitude_Of_Origin",33.5],)"
    R"(UNIT["Foot_US",0.3048006096012192]])";

/// A source of this content with a comment, and one with a remark in its place.
Declaration with_comment(const std::string& key, const std::string& declared,
                         const std::string& content = kPointLines.substr(0, 24),
                         const std::string& name = "source.xyz") {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            write_file(folder.file(name),
                       (is_declared ? declared : "# made by hand") + "\n" + content);
            return {folder.file(name)};
          }};
}

/// A source of this content, with a .prj beside it or without one.
Declaration beside_prj(const std::string& key, const std::string& name,
                       const std::string& content) {
  return {key, [=](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
            write_file(folder.file(name), content);
            if (is_declared) write_file(folder.file("source.prj"), kFeetPrj);
            return {folder.file(name)};
          }};
}

std::string las_file_with(const std::vector<LasRecord>& records) {
  LasFileMaker maker;
  maker.minor = 4;
  maker.records = records;
  for (int i = 0; i < 9; ++i) maker.points.push_back({1000 * (i % 3), 1000 * (i / 3), 100 * i});
  return maker.bytes();
}

std::string dxf_points() {
  std::string text = "0\nSECTION\n2\nENTITIES\n";
  for (const char* corner : {"00", "90", "99", "09"}) {
    text += std::string("0\nPOINT\n8\n0\n10\n") + corner[0] + "\n20\n" + corner[1] + "\n30\n7\n";
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

std::vector<Declaration> of_comments() {
  return {
      with_comment("text.comment_crs", "# crs: EPSG:2154"),
      with_comment("text.comment_gmt", "# @VGMT1.0 @GPOINT\n# @Je32611 @Jp\"+proj=utm +zone=11\""),
      with_comment("text.comment_vertical_crs", "# crs: EPSG:2154\n# vertical crs: EPSG:5773"),
      with_comment("text.comment_units", "# units: feet"),
      with_comment("text.comment_nodata", "# nodata -9999", kPointLines),
      with_comment("text.comment_shift", "//Global shift: -500000 -4000000 0"),
      with_comment("text.comment_in_words", "# Coordinate system: UTM 33N"),
      with_comment("mesh.comment_unit", "# File units = feet", kObjTin, "source.obj"),
      with_comment("mesh.comment_in_words", "# Up axis: Y", kObjTin, "source.obj"),
  };
}

std::vector<Declaration> of_prj() {
  return {
      beside_prj("text.prj", "source.csv", "x,y,z\n0,0,1\n9,0,2\n9,9,3\n0,9,4\n"),
      beside_prj("text.prj_other", "source.xyz", "# crs: EPSG:2154\n0 0 1\n9 0 2\n9 9 3\n0 9 4\n"),
      beside_prj("las.prj", "source.las", las_file_with({})),
      beside_prj("las.prj_other", "source.las", las_file_with({{2112, "EPSG:32617"}})),
      beside_prj("layer.prj", "source.dxf", dxf_points()),
      beside_prj("mesh.prj", "source.obj", kObjTin),
      beside_prj("mesh.prj_other", "source.ply",
                 "ply\nformat ascii 1.0\ncomment crs: EPSG:25832\n" + kPlyTail),
  };
}

}  // namespace

std::vector<Declaration> companion_declarations() {
  std::vector<Declaration> all = of_comments();
  const std::vector<Declaration> more = of_prj();
  all.insert(all.end(), more.begin(), more.end());
  all.push_back({"mesh.obj_weight",
                 [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
                   const std::string w = is_declared ? " 0.5\n" : " 1\n";
                   write_file(folder.file("source.obj"),
                              "v 0 0 1" + w + "v 9 0 2" + w + "v 9 9 3" + w + "f 1 2 3\n");
                   return {folder.file("source.obj")};
                 }});
  all.push_back({"mesh.obj_weight_none",
                 [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
                   write_file(folder.file("source.obj"), std::string("v 0 0 1 ") +
                                                             (is_declared ? "0" : "1") + "\n" +
                                                             kObjTin.substr(8));
                   return {folder.file("source.obj")};
                 }});
  all.push_back(
      {"raster.prj", [](const TestFolder& folder, bool is_declared) -> std::vector<std::string> {
         RasterRecipe recipe;
         recipe.epsg = 0;
         make_raster(folder.file("source.tif"), recipe);
         if (is_declared) write_file(folder.file("source.prj"), kFeetPrj);
         return {folder.file("source.tif")};
       }});
  return all;
}

}  // namespace ptin::tools::testing
