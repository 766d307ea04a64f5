// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points and lines as callers give them: layers in any CRS, WKT of any length, lines of several
// parts.
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

constexpr double kWest = 500015.0;    // centre of the western column
constexpr double kNorth = 3999985.0;  // centre of the northern row

/// A plane that rises by 1 a column and 10 a row to the south, in EPSG:32611.
std::string plane(const TestFolder& folder) {
  testing::RasterRecipe recipe;
  recipe.value = [](int column, int row) { return column + 10.0 * row; };
  testing::make_raster(folder.file("plane.tif"), recipe);
  const Outcome built =
      run_ptin({"build", folder.file("plane.tif"), "-o", folder.file("plane.ptin"), "-q"});
  EXPECT_EQ(built.status, 0) << built.err;
  return folder.file("plane.ptin");
}

/// Longitude and latitude of a sample.
json degrees_at(double column, double row) {
  OGRSpatialReference from;
  OGRSpatialReference to;
  from.importFromEPSG(32611);
  to.importFromEPSG(4326);
  to.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> transform(
      OGRCreateCoordinateTransformation(&from, &to));
  double x = kWest + 30 * column;
  double y = kNorth - 30 * row;
  EXPECT_TRUE(transform->Transform(1, &x, &y));
  return json::array({x, y});
}

std::string geojson(const json& type, const json& coordinates) {
  const json feature = {{"type", "Feature"},
                        {"properties", json::object()},
                        {"geometry", {{"type", type}, {"coordinates", coordinates}}}};
  return json({{"type", "FeatureCollection"}, {"features", json::array({feature})}}).dump();
}

std::string sample(double column, double row) {
  return std::to_string(kWest + 30 * column) + " " + std::to_string(kNorth - 30 * row);
}

TEST(VectorInput, TransformsPointsToTheTerrainsCrs) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  write_file(folder.file("p.geojson"), geojson("Point", degrees_at(7, 20)));
  const json point = answer_of({"locate", terrain, "--points", folder.file("p.geojson"), "--json"})
                         .at("points")[0];
  EXPECT_EQ(point.at("state"), "surface");
  EXPECT_NEAR(point.at("height").get<double>(), 207.0, 1e-6);
  EXPECT_NEAR(point.at("x").get<double>(), kWest + 210, 1e-6) << "told in the terrain's CRS";
}

TEST(VectorInput, TransformsLinesAndTakesAllTheirParts) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const json first = json::array({degrees_at(2, 3), degrees_at(2, 9)});
  const json second = json::array({degrees_at(20, 3), degrees_at(28, 3)});
  write_file(folder.file("l.geojson"), geojson("MultiLineString", json::array({first, second})));
  const json all = answer_of({"profile", terrain, "--line", folder.file("l.geojson"), "--json"});
  EXPECT_EQ(all.at("lines"), 2);
  EXPECT_NEAR(all.at("length").get<double>(), 30 * (6 + 8), 1e-3);
  EXPECT_NEAR(all.at("points").front().at("height").get<double>(), 32.0, 1e-6);
  EXPECT_NEAR(all.at("points").back().at("height").get<double>(), 58.0, 1e-6);
  EXPECT_EQ(all.at("points").back().at("line"), 1);
}

TEST(VectorInput, TakesWktOfAnyLengthAndOfSeveralParts) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  std::string track;
  for (int i = 0; i < 4000; ++i) {
    track.append(track.empty() ? "" : ",").append(sample(2 + i % 2, 1 + i * 0.005));
  }
  ASSERT_GT(track.size(), 65536u);
  write_file(folder.file("t.wkt"), "  linestring (" + track + ")\n");
  EXPECT_EQ(answer_of({"profile", terrain, "--line", folder.file("t.wkt"), "--json"}).at("lines"),
            1);
  const std::string two = "MULTILINESTRING((" + sample(1, 1) + "," + sample(3, 1) + "),(" +
                          sample(8, 1) + "," + sample(9, 1) + "))";
  EXPECT_EQ(answer_of({"profile", terrain, "--line", two, "--json"}).at("length"), 90.0);
}

TEST(VectorInput, TakesFilesWhoseNamesBeginAsWktDoes) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const std::string here = std::filesystem::current_path();
  const std::string line = geojson("LineString", json::array({degrees_at(2, 3), degrees_at(2, 9)}));
  std::filesystem::current_path(folder.path());
  for (const std::string name : {"LineString_roads.geojson", "linestring.geojson", "linestringz",
                                 "linestring(1).geojson", "LINESTRING EMPTY.geojson"}) {
    write_file(name, line);
    EXPECT_EQ(answer_of({"profile", terrain, "--line", name, "--json"}).at("lines"), 1) << name;
  }
  const std::string wkt = "linestring zm (" + sample(1, 1) + " 0 0," + sample(3, 1) + " 0 0)";
  EXPECT_EQ(answer_of({"profile", terrain, "--line", wkt, "--json"}).at("length"), 60.0);
  std::filesystem::current_path(here);
}

TEST(VectorInput, SkipsLinesWithoutLengthAmongOthersAndSaysHowMany) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const std::string none = "(" + sample(2, 2) + "," + sample(2, 2) + ")";
  const std::string line = "(" + sample(1, 1) + "," + sample(3, 1) + ")";
  const auto run = [&](const std::string& wkt, const char* more) {
    return run_ptin({"profile", terrain, "--line", wkt, more});
  };
  const std::string some = "MULTILINESTRING(" + none + "," + line + "," + none + ")";
  const json answer = json::parse(run(some, "--json").out);
  EXPECT_EQ(answer.at("lines"), 1);
  EXPECT_EQ(answer.at("skipped_lines"), 2);
  EXPECT_EQ(answer.at("length"), 60.0);
  EXPECT_EQ(answer.at("points").front().at("line"), 1) << "numbered as they were given";
  EXPECT_NE(run_ptin({"profile", terrain, "--line", some}).err.find("2 of 3 lines"),
            std::string::npos);
  const auto refused = [&](const std::string& wkt, const char* words) {
    const Outcome outcome = run(wkt, "--json");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  refused("LINESTRING" + none, "the line has no length");
  refused("MULTILINESTRING(" + none + "," + none + ")", "none of the 2 lines");
  refused("MULTILINESTRING(" + line + ",(1e30 0, 0 0))", "line 2 of 2");
}

/// A recording of a tour: a GPX has five layers, of which three are points and two are lines.
std::string gpx(const std::string& more) {
  const auto at = [](const char* element, double column, double row) {
    const json degrees = degrees_at(column, row);
    return std::string("<") + element + " lat=\"" + degrees[1].dump() + "\" lon=\"" +
           degrees[0].dump() + "\"><name>" + element + std::to_string(static_cast<int>(column)) +
           "</name></" + element + ">";
  };
  return R"(<?xml version="1.0"?><gpx version="1.1" creator="test" )"
         R"(xmlns="http://www.topografix.com/GPX/1/1">)" +
         (more == "waypoints" ? at("wpt", 7, 20) + at("wpt", 9, 3) : "") +
         (more == "route" ? "<rte><name>R</name>" + at("rtept", 1, 1) + at("rtept", 1, 9) + "</rte>"
                          : "") +
         "<trk><name>T</name><trkseg>" + at("trkpt", 2, 2) + at("trkpt", 8, 2) + at("trkpt", 8, 4) +
         "</trkseg></trk></gpx>";
}

TEST(Layers, OfAFittingTypeAreTakenByThemselves) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const std::string file = folder.file("a.gpx");
  const auto lines = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"profile", terrain, "--line", file, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments);
  };
  const auto points = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"locate", terrain, "--points", file, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments).at("points");
  };
  write_file(file, gpx(""));
  EXPECT_NEAR(lines({}).at("length").get<double>(), 240.0, 1e-3) << "of the track";
  EXPECT_EQ(points({}).size(), 3u) << "of the track";
  const Outcome wrong = run_ptin({"profile", terrain, "--line", file, "--layer", "waypoints"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("not lines"), std::string::npos) << wrong.err;
  EXPECT_EQ(run_ptin({"profile", terrain, "--line", file, "--layer", "nothing"}).status, 2);

  write_file(file, gpx("waypoints"));
  const Outcome unclear = run_ptin({"locate", terrain, "--points", file});
  EXPECT_EQ(unclear.status, 2);
  EXPECT_EQ(unclear.out, "");
  EXPECT_NE(unclear.err.find("'waypoints' (Point), 'track_points' (Point); name one with --layer"),
            std::string::npos)
      << unclear.err;
  EXPECT_EQ(points({"--layer", "waypoints"}).size(), 2u);
  EXPECT_NEAR(points({"--layer", "waypoints"}).at(0).at("height").get<double>(), 207.0, 1e-4);

  write_file(file, gpx("route"));
  EXPECT_EQ(run_ptin({"profile", terrain, "--line", file}).status, 2);
  EXPECT_NEAR(lines({"--layer", "routes"}).at("length").get<double>(), 240.0, 1e-3);
  EXPECT_EQ(run_ptin({"profile", terrain, "--line", "LINESTRING(0 0, 1 1)", "--layer", "a"}).status,
            2);
}

TEST(Layers, OfPolygonsAreFoundBehindOthers) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const std::string file = folder.file("areas.gpkg");
  const GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GPKG")->Create(
      file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  const auto add = [&](const char* name, OGRwkbGeometryType type, const std::string& wkt) {
    OGRSpatialReference crs;
    crs.importFromEPSG(32611);
    OGRLayer& layer = *data->CreateLayer(name, &crs, type);
    OGRFeature feature(layer.GetLayerDefn());
    OGRGeometry* geometry = nullptr;
    OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &geometry);
    feature.SetGeometryDirectly(geometry);
    EXPECT_EQ(layer.CreateFeature(&feature), OGRERR_NONE);
    data->FlushCache();
  };
  const auto refined = [&] {
    return run_ptin({"refine", terrain, "--polygon", file, "--cut", "-o", folder.file("cut.ply"),
                     "--overwrite", "-q"});
  };
  const std::string area = "POLYGON((" + sample(2, 2) + "," + sample(9, 2) + "," + sample(9, 9) +
                           "," + sample(2, 2) + "))";
  add("corners", wkbPoint, "POINT(" + sample(2, 2) + ")");
  EXPECT_NE(refined().err.find("holds Point, not polygons"), std::string::npos) << refined().err;
  add("parish", wkbPolygon, area);
  EXPECT_EQ(refined().status, 0) << refined().err;
  add("farm", wkbMultiPolygon, "MULTIPOLYGON(" + area.substr(7) + ")");
  EXPECT_EQ(refined().status, 2);
  EXPECT_NE(refined().err.find("'parish' (Polygon), 'farm' (Multi Polygon)"), std::string::npos)
      << refined().err;
}

TEST(Layers, OfLinesArePairsForSight) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const std::string file = folder.file("links.geojson");
  const auto end = [](double column, double row, double height) {
    json place = degrees_at(column, row);
    if (height > 0) place.push_back(height);
    return place;
  };
  const auto asked = [&] { return run_ptin({"sight", terrain, "--pairs", file, "--json"}); };
  write_file(file, geojson("LineString", json::array({end(5, 20, 30), end(25, 4, 40)})));
  const json of_layer = answer_of({"sight", terrain, "--pairs", file, "--json"}).at("pairs").at(0);
  write_file(folder.file("links.txt"), "500165 3999385 30 500765 3999865 40\n");
  const json of_text = answer_of({"sight", terrain, "--pairs", folder.file("links.txt"), "--json"})
                           .at("pairs")
                           .at(0);
  EXPECT_EQ(of_layer.at("verdict"), "visible");
  EXPECT_NEAR(of_layer.at("clearance").at("min").get<double>(),
              of_text.at("clearance").at("min").get<double>(), 1e-3);
  write_file(file, geojson("LineString", json::array({end(5, 20, 0), end(25, 4, 0)})));
  EXPECT_NE(asked().err.find("has no heights"), std::string::npos) << asked().err;
  json with_attributes = json::parse(testing::read_file(file));
  with_attributes["features"][0]["properties"] = {{"h1", 30}, {"h2", 40}};
  write_file(file, with_attributes.dump());
  EXPECT_EQ(json::parse(asked().out).at("pairs").at(0).at("clearance"), of_layer.at("clearance"));
  write_file(file,
             geojson("LineString", json::array({end(5, 20, 3), end(9, 9, 3), end(25, 4, 3)})));
  EXPECT_EQ(asked().status, 2);
  EXPECT_NE(asked().err.find("no line of two points"), std::string::npos) << asked().err;
}

class PolygonLayer : public ::testing::Test {
 protected:
  PolygonLayer() {
    testing::RasterRecipe recipe;
    recipe.pixel = 1;
    recipe.west = 0;
    recipe.north = 33;
    testing::make_raster(folder_.file("t.tif"), recipe);
    testing::expect_done({"build", folder_.file("t.tif"), "-o", folder_.file("t.ptin"), "-q"});
  }
  using Ring = std::vector<std::array<double, 2>>;
  static Ring square(double low) {
    const double high = low + 10;
    return {{low, low}, {high, low}, {high, high}, {low, high}, {low, low}};
  }
  /// Of what is cut out by features with these rings.
  double area_of(const std::vector<std::vector<Ring>>& features) {
    json layer = {
        {"type", "FeatureCollection"},
        {"crs", {{"type", "name"}, {"properties", {{"name", "urn:ogc:def:crs:EPSG::32611"}}}}},
        {"features", json::array()}};
    for (const std::vector<Ring>& polygons : features) {
      json parts = json::array();
      for (const Ring& ring : polygons) parts.push_back(json::array({ring}));
      layer["features"].push_back(
          {{"type", "Feature"},
           {"properties", json::object()},
           {"geometry", {{"type", "MultiPolygon"}, {"coordinates", parts}}}});
    }
    write_file(folder_.file("layer.geojson"), layer.dump());
    testing::expect_done({"refine", folder_.file("t.ptin"), "--polygon",
                          folder_.file("layer.geojson"), "--cut", "-o", folder_.file("cut.ply"),
                          "-q", "--overwrite"});
    const testing::ReadMesh mesh = testing::read_ply(testing::read_file(folder_.file("cut.ply")));
    double area = 0;
    for (const auto& t : mesh.triangles) {
      const auto &a = mesh.vertices.at(t[0]), &b = mesh.vertices.at(t[1]),
                 &c = mesh.vertices.at(t[2]);
      area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    return area;
  }
  TestFolder folder_;
};

// Even-odd would leave out what two features share.
TEST_F(PolygonLayer, CoversWhatAnyOfTwoOverlappingPolygonsCovers) {
  EXPECT_NEAR(area_of({{square(2)}, {square(7)}}), 2 * 100 - 25, 1e-6);
}

// Whatever else is in the layer, a feature is what an odd number of its rings surround.
TEST_F(PolygonLayer, HasTheSameFeaturesTogetherAsAlone) {
  const std::vector<Ring> overlapping = {square(2), square(7)};
  const std::vector<Ring> crossing = {{{2, 2}, {12, 12}, {12, 2}, {2, 12}, {2, 2}}};
  const std::vector<Ring> apart = {square(20)};
  EXPECT_NEAR(area_of({overlapping}), 150, 1e-6);
  EXPECT_NEAR(area_of({overlapping, apart}), 250, 1e-6);
  EXPECT_NEAR(area_of({crossing}), 50, 1e-6);
  EXPECT_NEAR(area_of({crossing, apart}), 150, 1e-6);
}

TEST(VectorInput, SaysWhatIsNoLine) {
  const TestFolder folder;
  const std::string terrain = plane(folder);
  const auto status = [&](const std::string& line, const std::string& words) {
    const Outcome outcome = run_ptin({"profile", terrain, "--line", line});
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(testing::lines_in(outcome.err), 1u) << outcome.err;
    return outcome.status;
  };
  EXPECT_EQ(status("LINESTRING(1 2", "WKT"), 2);
  EXPECT_EQ(status("LINESTRING(1 2)", "two"), 2);
  EXPECT_EQ(status(std::string(5000, 'x'), "no such file"), 3);
  EXPECT_EQ(status(folder.file("none.gpkg"), "no such file"), 3);
  EXPECT_EQ(status(folder.path().string(), "vector file"), 2);
  write_file(folder.file("p.geojson"), geojson("Point", degrees_at(7, 20)));
  EXPECT_EQ(status(folder.file("p.geojson"), "holds Point, not lines"), 2);
}

}  // namespace
}  // namespace ptin::tools
