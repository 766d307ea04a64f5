// SPDX-License-Identifier: GPL-3.0-or-later
//
// No output takes the place of what it is made from.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::make_raster;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

/// Runs it with --overwrite, and expects that `input` stays as it is.
void expect_kept(const TestFolder& folder, std::vector<std::string> arguments,
                 const std::string& input) {
  const std::string before = read_file(input);
  const auto names = folder.names();
  arguments.emplace_back("--overwrite");
  const Outcome outcome = run_ptin(arguments);
  EXPECT_EQ(outcome.status, 2) << arguments[0] << ": " << outcome.err;
  EXPECT_EQ(testing::lines_in(outcome.err), 1U) << outcome.err;
  EXPECT_NE(outcome.err.find("would destroy it"), std::string::npos) << outcome.err;
  EXPECT_TRUE(read_file(input) == before) << arguments[0] << " destroyed " << input;
  EXPECT_EQ(folder.names(), names) << arguments[0];
  write_file(input, before);
}

struct NamedTerrain {
  TestFolder folder;
  std::string raster = folder.file("hills.tif"), store = folder.file("hills.ptin");
  NamedTerrain() {
    make_raster(raster, {});
    testing::expect_done({"build", raster, "-o", store, "-q"});
  }
};

TEST(KeptInputs, ByTheirOwnNameAndThroughLinks) {
  const NamedTerrain t;
  expect_kept(t.folder, {"build", t.raster, "-o", t.raster}, t.raster);
  const std::string hard = t.folder.file("hard.tif");
  const std::string soft = t.folder.file("soft.tif");
  std::filesystem::create_hard_link(t.raster, hard);
  std::filesystem::create_symlink("hills.tif", soft);
  expect_kept(t.folder, {"build", t.raster, "-o", hard}, t.raster);
  expect_kept(t.folder, {"build", soft, "-o", hard}, t.raster);
  expect_kept(t.folder, {"build", t.raster, "-o", soft}, t.raster);
}

TEST(KeptInputs, OfEveryCommandThatWrites) {
  const NamedTerrain t;
  const auto linked = [&](const std::string& name) {
    std::filesystem::create_hard_link(t.store, t.folder.file(name));
    return t.folder.file(name);
  };
  expect_kept(t.folder, {"stream", t.store, "-o", t.store}, t.store);
  expect_kept(t.folder, {"export", t.store, "-o", linked("a.tif")}, t.store);
  expect_kept(t.folder, {"refine", t.store, "-o", linked("a.ply")}, t.store);
  expect_kept(t.folder, {"isoline", t.store, "--interval", "20", "-o", linked("a.gpkg")}, t.store);
  expect_kept(t.folder, {"render", t.store, "-o", linked("a.png")}, t.store);
  expect_kept(
      t.folder,
      {"viewshed", t.store, "500500", "3999500", "2", "--radius", "99", "-o", linked("b.tif")},
      t.store);
  const std::string stream = t.folder.file("a.pts");
  testing::expect_done({"stream", t.store, "-o", stream});
  std::filesystem::create_hard_link(stream, t.folder.file("c.ply"));
  expect_kept(t.folder, {"unstream", stream, "-o", t.folder.file("c.ply")}, stream);
}

TEST(KeptInputs, LinesPolygonsAndTheSourcesOfAVrt) {
  const NamedTerrain t;
  const std::string road = t.folder.file("road.geojson");
  write_file(road, R"({"type":"LineString","coordinates":[[500100,3999900],[500700,3999300]]})");
  expect_kept(t.folder, {"profile", t.store, "--line", road, "-o", road}, road);
  const std::string area = t.folder.file("area.geojson");
  write_file(area, R"({"type":"Polygon","coordinates":[[[500100,3999300],[500700,3999300],)"
                   R"([500400,3999900],[500100,3999300]]]})");
  std::filesystem::create_hard_link(area, t.folder.file("area.ply"));
  expect_kept(t.folder,
              {"refine", t.store, "--polygon", area, "--clip", "-o", t.folder.file("area.ply")},
              area);
  const std::string mosaic = t.folder.file("mosaic.vrt");
  write_file(mosaic,
             "<VRTDataset rasterXSize=\"33\" rasterYSize=\"33\">"
             "<GeoTransform>0, 1, 0, 0, 0, -1</GeoTransform>"
             "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>"
             "<SourceFilename relativeToVRT=\"1\">hills.tif</SourceFilename>"
             "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>");
  expect_kept(t.folder, {"build", mosaic, "-o", t.raster}, t.raster);
}

TEST(KeptInputs, OtherFilesAreReplacedAsBefore) {
  const NamedTerrain t;
  testing::expect_done({"build", t.raster, "-o", t.store, "-q", "--overwrite"});
  const std::string copy = t.folder.file("copy.tif");
  std::filesystem::copy_file(t.raster, copy);
  testing::expect_done({"export", t.store, "-o", copy, "-q", "--overwrite"});
}

}  // namespace
}  // namespace ptin::tools
