// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin isoline end to end: formats, conventions, refusals; level sets against gdal_contour's.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

struct Feature {
  int id = -1;
  std::vector<double> values;
  std::unique_ptr<OGRGeometry> geometry;
};

std::vector<Feature> read_layer(const std::string& path, const std::string& name = "contour") {
  GDALAllRegister();
  const GDALDatasetUniquePtr dataset(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
  std::vector<Feature> features;
  if (!dataset) {
    ADD_FAILURE() << path << " is not a vector file";
    return features;
  }
  OGRLayer* layer = dataset->GetLayerByName(name.c_str());
  if (layer == nullptr) layer = dataset->GetLayer(0);  // FlatGeobuf and shapefiles name by file
  EXPECT_NE(layer->GetSpatialRef(), nullptr);
  for (const auto& f : *layer) {
    Feature feature;
    feature.id = f->GetFieldAsInteger("ID");
    for (const char* field : {"elev", "elev_min", "elev_max"}) {
      if (f->GetFieldIndex(field) >= 0) feature.values.push_back(f->GetFieldAsDouble(field));
    }
    feature.geometry.reset(f->GetGeometryRef()->clone());
    features.push_back(std::move(feature));
  }
  return features;
}

struct Mountains {
  TestFolder folder;
  std::string file = testing::built(folder, "mountains_257.tif", "m.ptin");
};

TEST(IsolineProgram, WritesTheSameLinesInEveryFormat) {
  const Mountains m;
  std::vector<std::string> texts;
  for (const char* name : {"a.gpkg", "a.fgb", "a.geojson", "a.shp"}) {
    const std::string out = m.folder.file(name);
    const Outcome outcome =
        run_ptin({"isoline", m.file, "--interval", "100", "-o", out, "--json", "--3d"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const json answer = json::parse(outcome.out);
    const std::vector<Feature> features = read_layer(out);
    EXPECT_EQ(features.size(), answer.at("lines"));
    EXPECT_GT(features.size(), 10U);
    EXPECT_EQ(answer.at("exact"), true);
    double length = 0;
    for (const Feature& f : features) {
      EXPECT_EQ(std::fmod(f.values.at(0), 100.0), 0.0);
      EXPECT_EQ(f.geometry->toLineString()->getZ(0), f.values.at(0));
      length += f.geometry->toLineString()->get_Length();
    }
    texts.push_back(std::to_string(features.size()) + " " +
                    std::to_string(static_cast<std::int64_t>(length)));
  }
  EXPECT_EQ(std::count(texts.begin(), texts.end(), texts.front()), 4);
  EXPECT_EQ(m.folder.names(), (std::vector<std::string>{"a.dbf", "a.fgb", "a.geojson", "a.gpkg",
                                                        "a.prj", "a.shp", "a.shx", "m.ptin"}));
}

TEST(IsolineProgram, PolygonsAreValidAndCoverTheSurface) {
  const TestFolder folder;
  struct Case {
    const char* raster;
    std::vector<std::string> options;
  };
  const std::vector<Case> cases = {{"mountains_257.tif", {"--interval", "50"}},
                                   {"mountains_257.tif", {"--interval", "100", "--error", "20"}},
                                   {"mountains_257.tif", {"--level", "1000", "1001", "1002"}},
                                   {"coast_257.tif", {"--interval", "10"}},
                                   {"coast_257.tif", {"--level", "0", "1", "5"}}};
  for (const Case& c : cases) {
    const std::string file = testing::built(folder, c.raster);
    std::vector<std::string> arguments = {
        "isoline", file, "--polygons", "-o", folder.file("p.gpkg"), "--overwrite", "-q"};
    arguments.insert(arguments.end(), c.options.begin(), c.options.end());
    const Outcome outcome = run_ptin(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    double area = 0;
    double before = -1e9;
    for (const Feature& f : read_layer(folder.file("p.gpkg"))) {
      EXPECT_TRUE(f.geometry->IsValid()) << c.raster << " " << f.values[0] << " " << c.options[0];
      EXPECT_LT(f.values.at(0), f.values.at(1));
      EXPECT_GE(f.values.at(0), before);
      before = f.values.at(1);
      area += f.geometry->toMultiPolygon()->get_Area();
    }
    const GDALDatasetUniquePtr raster(GDALDataset::Open(test_data(c.raster).c_str()));
    double g[6];
    raster->GetGeoTransform(g);
    if (std::string(c.raster) == "mountains_257.tif") {
      EXPECT_NEAR(area / (256 * 256 * g[1] * -g[5]), 1.0, 1e-9);
    }
  }
}

/// A TIN of 40 x 40 points, all used, on which every other cell of a part is a hole: its vertices
/// are a full grid, its surface is none.
std::string grid_with_holes(int* holes) {
  constexpr int kAcross = 40;
  std::ostringstream vertices, faces;
  int count = 0;
  for (int y = 0; y < kAcross; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      vertices << x << ' ' << y << ' ' << x + 0.03 * ((x * 7 + y * 13) % 10) << '\n';
      if (x + 1 == kAcross || y + 1 == kAcross) continue;
      if (20 <= x && x < 34 && 8 <= y && y < 30 && x % 2 == 0 && y % 2 == 0) {
        ++*holes;
        continue;
      }
      const int a = y * kAcross + x;
      faces << "3 " << a << ' ' << a + 1 << ' ' << a + kAcross + 1 << "\n3 " << a << ' '
            << a + kAcross + 1 << ' ' << a + kAcross << '\n';
      count += 2;
    }
  }
  return "ply\nformat ascii 1.0\nelement vertex 1600\nproperty double x\nproperty double y\n"
         "property double z\nelement face " +
         std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices.str() + faces.str();
}

TEST(IsolineProgram, PolygonsLeaveOutTheHolesOfATin) {
  const TestFolder folder;
  int holes = 0;
  testing::write_file(folder.file("holes.ply"), grid_with_holes(&holes));
  ASSERT_EQ(holes, 77);
  testing::expect_done({"build", folder.file("holes.ply"), "-o", folder.file("holes.ptin"),
                        "--a-srs", "EPSG:32611", "-q"});
  const json answer =
      testing::answer_of({"isoline", folder.file("holes.ptin"), "--polygons", "--interval", "5",
                          "-o", folder.file("bands.gpkg"), "--json"});
  EXPECT_EQ(answer.at("exact"), true);
  double area = 0;
  for (const Feature& f : read_layer(folder.file("bands.gpkg"))) {
    area += f.geometry->toMultiPolygon()->get_Area();
  }
  EXPECT_NEAR(area, 39 * 39 - holes, 1e-6);
}

TEST(IsolineProgram, PolygonsOfTwoWindowsShareTheirBorder) {
  const Mountains m;
  GDALAllRegister();
  const GDALDatasetUniquePtr raster(GDALDataset::Open(test_data("mountains_257.tif").c_str()));
  double g[6];
  raster->GetGeoTransform(g);
  const double west = g[0], north = g[3], east = g[0] + 257 * g[1], south = g[3] + 257 * g[5];
  const double middle = west + 100.3 * g[1];
  double area = 0;
  for (const auto& [a, b] : {std::pair{west, middle}, std::pair{middle, east}}) {
    const std::string out = m.folder.file("w.gpkg");
    const auto text = [](double v) { return json(v).dump(); };
    const Outcome outcome =
        run_ptin({"isoline", m.file, "--interval", "100", "--polygons", "-o", out, "--overwrite",
                  "-q", "--window", text(a), text(south), text(b), text(north)});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    for (const Feature& f : read_layer(out)) {
      EXPECT_TRUE(f.geometry->IsValid());
      area += f.geometry->toMultiPolygon()->get_Area();
    }
  }
  EXPECT_NEAR(area / (256 * 256 * g[1] * -g[5]), 1.0, 1e-9);
}

TEST(IsolineProgram, WritesGeoJsonToStdout) {
  const Mountains m;
  const Outcome outcome = run_ptin({"isoline", m.file, "--level", "1000", "-o", "-"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const json answer = json::parse(outcome.out, nullptr, false);
  EXPECT_GT(answer.at("features").size(), 0U);
  EXPECT_EQ(answer.at("features").at(0).at("properties").at("elev"), 1000.0);
}

/// GeoJSON names a CRS by its code or not at all; other formats keep its definition.
TEST(IsolineProgram, WarnsWhereGeoJsonLosesTheCrs) {
  const TestFolder folder;
  const std::string store = folder.file("m.ptin");
  BuildOptions options;
  options.a_srs = "+proj=laea +lat_0=34 +lon_0=-118 +units=m";
  testing::RasterRecipe recipe;
  recipe.value = testing::hills;
  testing::make_raster(folder.file("m.tif"), recipe);
  testing::build_terrain(folder.file("m.tif"), store, options);
  const auto told = [&](const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"isoline", store, "--interval", "10", "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_ptin(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.err;
  };
  const std::string lost = "this one has none; .gpkg and .fgb keep it";
  EXPECT_NE(told(folder.file("a.geojson")).find(lost), std::string::npos);
  EXPECT_NE(told(folder.file("b.geojson"), {"--polygons"}).find(lost), std::string::npos);
  EXPECT_NE(told("-").find("the GeoJSON does not say its CRS"), std::string::npos);
  EXPECT_EQ(told(folder.file("a.gpkg")), "");
  EXPECT_EQ(told(folder.file("a.xml")), "");
  EXPECT_EQ(told(folder.file("c.geojson"), {"-q"}), "");
  const Outcome points =
      run_ptin({"locate", store, "500100", "3999900", "-o", folder.file("p.json")});
  EXPECT_NE(points.err.find(lost), std::string::npos) << points.err;
}

TEST(IsolineProgram, RefusesWhatCannotBeAnswered) {
  const Mountains m;
  const std::string out = m.folder.file("x.gpkg");
  const auto refused = [&](std::vector<std::string> arguments, int status, const char* word) {
    arguments.insert(arguments.begin(), {"isoline", m.file, "-o", out});
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, status) << word;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_EQ(m.folder.names(), std::vector<std::string>{"m.ptin"});
  };
  refused({}, 2, "--level");
  refused({"--interval", "-5"}, 2, "interval");
  refused({"--interval", "5", "--max-lines", "-1"}, 2, "must be a whole number >= 0; -1 is none");
  refused({"--interval", "0.0000001"}, 2, "levels");
  refused({"--level", "1000", "--error", "-1"}, 2, "--error");
  refused({"--interval", "10", "--max-lines", "3"}, 7, "isolines, more than the limit of 3");
  refused({"--interval", "10", "--memory", "100K"}, 7, "KiB");
  refused({"--level", "1", "--interval", "1"}, 2, "excludes");
  refused({"--interval", "1", "--polygons", "--by", "splits"}, 2, "excludes");
  const Outcome extension = run_ptin({"isoline", m.file, "--level", "1", "-o", "x.doc"});
  EXPECT_EQ(extension.status, 2);
  EXPECT_NE(extension.err.find(".gpkg"), std::string::npos);
}

TEST(IsolineProgram, KeepsWhatExistsWithoutOverwrite) {
  const Mountains m;
  const std::string out = m.folder.file("x.gpkg");
  testing::write_file(out, "mine");
  EXPECT_EQ(run_ptin({"isoline", m.file, "--level", "1000", "-o", out}).status, 2);
  EXPECT_EQ(testing::read_file(out), "mine");
  EXPECT_EQ(run_ptin({"isoline", m.file, "--level", "1000", "-o", out, "--overwrite"}).status, 0);
  EXPECT_FALSE(read_layer(out).empty());
}

}  // namespace
}  // namespace ptin::tools
