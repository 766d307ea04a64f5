// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin isoline and highest with --polygon, against GEOS and against the areas of ptin volume.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;

/// The mountains, and a polygon with a hole.
class PolygonQuestion : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  /// The only layer of a file, as one geometry a feature, with `elev` or `elev_min`.
  struct Shape {
    double level;
    std::unique_ptr<OGRGeometry> geometry;
  };
  static std::vector<Shape> shapes_in(const std::string& path, const char* field) {
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
    std::vector<Shape> shapes;
    if (!data || data->GetLayerCount() != 1) {
      ADD_FAILURE() << path;
      return shapes;
    }
    for (const auto& feature : *data->GetLayer(0)) {
      shapes.push_back({feature->GetFieldAsDouble(field),
                        std::unique_ptr<OGRGeometry>(feature->GetGeometryRef()->clone())});
    }
    return shapes;
  }
  static std::unique_ptr<OGRGeometry> shape_of(const std::string& wkt) {
    OGRGeometry* shape = nullptr;
    OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &shape);
    return std::unique_ptr<OGRGeometry>(shape);
  }
  static double length_of(const OGRGeometry& g) {
    if (const auto* line = dynamic_cast<const OGRLineString*>(&g)) return line->get_Length();
    double length = 0.0;
    if (const auto* all = dynamic_cast<const OGRGeometryCollection*>(&g)) {
      for (const auto* part : *all) length += length_of(*part);
    }
    return length;
  }

  TestFolder folder_;
  std::string terrain_ = testing::built(folder_, "mountains_257.tif");
  std::string polygon_ =
      "POLYGON((377500 3801500, 383000 3802500, 381000 3805000, 383500 3807500, 377000 3806800, "
      "379500 3804500, 377500 3801500),(379500 3803000, 381000 3803300, 380200 3804200, 379500 "
      "3803000))";
};

TEST_F(PolygonQuestion, OfIsolinesIsWhatGeosCuts) {
  const auto lines = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"isoline", terrain_,   "--level", "900", "1100", "1250.5",
                                      "-o",      file(name), "--error", "2",   "-q"};
    words.insert(words.end(), more.begin(), more.end());
    expect_done(words);
    return shapes_in(file(name), "elev");
  };
  const auto polygon = shape_of(polygon_);
  double want = 0.0;
  for (const Shape& line : lines("whole.geojson", {})) {
    const std::unique_ptr<OGRGeometry> inside(line.geometry->Intersection(polygon.get()));
    want += length_of(*inside);
  }
  double got = 0.0;
  const std::unique_ptr<OGRGeometry> border(polygon->Boundary());
  int closed = 0, cut = 0;
  for (const Shape& line : lines("part.geojson", {"--polygon", polygon_})) {
    got += length_of(*line.geometry);
    EXPECT_LT(line.geometry->Distance(polygon.get()), 1e-9);
    const auto& points = *line.geometry->toLineString();
    OGRPoint first, last;
    points.StartPoint(&first);
    points.EndPoint(&last);
    if (first.Equals(&last) != 0) {
      ++closed;
      continue;
    }
    ++cut;
    EXPECT_LT(first.Distance(border.get()), 1e-6);  // the terrain goes on all around
    EXPECT_LT(last.Distance(border.get()), 1e-6);
  }
  EXPECT_NEAR(got, want, 1e-4);
  EXPECT_GT(closed, 0);
  EXPECT_GT(cut, 10);
}

TEST_F(PolygonQuestion, OfBandsHasTheAreasThatVolumeTells) {
  expect_done({"isoline", terrain_, "--level", "900", "1100", "--polygons", "--polygon", polygon_,
               "-o", file("bands.geojson"), "-q"});
  double below = 0.0, above = 0.0, all = 0.0;
  for (const Shape& band : shapes_in(file("bands.geojson"), "elev_min")) {
    const double area = band.geometry->toMultiPolygon()->get_Area();
    all += area;
    if (band.level < 900) below += area;
    if (band.level >= 1100) above += area;
  }
  const json volumes =
      answer_of({"volume", terrain_, "--level", "900", "1100", "--polygon", polygon_, "--json"});
  const json& low = volumes.at("levels").at(0).at("area");
  EXPECT_NEAR(below, low.at("fill").get<double>(), 0.1);
  EXPECT_NEAR(above, volumes.at("levels").at(1).at("area").at("cut").get<double>(), 0.1);
  EXPECT_NEAR(all, low.at("surface").get<double>(), 0.1);
}

TEST_F(PolygonQuestion, OfTheHighestPointTellsItsBorder) {
  const std::string small =
      "POLYGON((380003 3803003, 380009 3803004, 380006 3803009, 380003 3803003))";
  const Outcome between = run_ptin({"highest", terrain_, "--polygon", small});
  EXPECT_NE(between.out.find("(on the polygon's border)"), std::string::npos) << between.out;
  const json point = answer_of({"highest", terrain_, "--polygon", small, "--json"}).at("point");
  const json there =
      answer_of({"locate", terrain_, point.at("x").dump(), point.at("y").dump(), "--json"});
  EXPECT_NEAR(point.at("height").get<double>(), there.at("points").at(0).at("height").get<double>(),
              1e-6);
  const json coarse =
      answer_of({"highest", terrain_, "--polygon", polygon_, "--error", "20", "--json"})
          .at("point");
  const double exact = answer_of({"highest", terrain_, "--polygon", polygon_, "--json"})
                           .at("point")
                           .at("height")
                           .get<double>();
  EXPECT_LE(coarse.at("height_min").get<double>(), exact);
  EXPECT_GE(coarse.at("height_max").get<double>(), exact);
}

/// A polygon of long sides, straight in degrees.
TEST_F(PolygonQuestion, OfAnotherCrsKeepsItsSidesStraight) {
  testing::write_file(file("area.geojson"),
                      R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon",)"
                      R"("coordinates":[[[-118.34,34.34],[-118.28,34.345],[-118.3,34.39],)"
                      R"([-118.34,34.34]]]}})");
  const std::string area = file("area.geojson");
  for (const json& answer :
       {answer_of({"highest", terrain_, "--polygon", area, "--json"}),
        answer_of({"isoline", terrain_, "--level", "1000", "--polygon", area, "-o",
                   file("lines.geojson"), "--json", "-q"}),
        answer_of({"isoline", terrain_, "--level", "1000", "--polygons", "--polygon", area, "-o",
                   file("bands.geojson"), "--json", "-q"})}) {
    EXPECT_EQ(answer.at("transformed").at("from"), "WGS 84");
    EXPECT_LE(answer.at("transformed").at("bent_at_most").get<double>(), 0.3);
  }
  const Outcome said = run_ptin({"highest", terrain_, "--polygon", area});
  EXPECT_NE(said.err.find("the polygon, straight in WGS 84"), std::string::npos) << said.err;
  EXPECT_TRUE(answer_of({"highest", terrain_, "--json"}).at("transformed").is_null());
}

TEST_F(PolygonQuestion, IsRefusedBesideAWindowAndOffTheTerrain) {
  const std::string far = "POLYGON((0 0, 1 0, 1 1, 0 0))";
  for (const std::vector<std::string>& asked :
       {std::vector<std::string>{"highest", terrain_},
        std::vector<std::string>{"isoline", terrain_, "--level", "9", "-o", file("a.gpkg")}}) {
    std::vector<std::string> both = asked, off = asked;
    both.insert(both.end(),
                {"--polygon", polygon_, "--window", "377500", "3801500", "378000", "3802000"});
    EXPECT_EQ(run_ptin(both).status, 2);
    off.insert(off.end(), {"--polygon", far});
    const Outcome missed = run_ptin(off);
    EXPECT_EQ(missed.status, 2);
    EXPECT_NE(missed.err.find("--polygon"), std::string::npos) << missed.err;
  }
}

}  // namespace
}  // namespace ptin::tools
