// SPDX-License-Identifier: GPL-3.0-or-later
//
// What meshes state of CRS and heights is read again by `ptin build` as it was.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
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
  /// The same of a terrain that is built from a mesh of that of points.
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

TEST_F(WrittenCrs, TellsTheVerticalCrs) {
  build({"--a-srs", "EPSG:25832+7837"});
  expect_the_same({".ply", ".obj", ".xml"});
}

}  // namespace
}  // namespace ptin::tools
