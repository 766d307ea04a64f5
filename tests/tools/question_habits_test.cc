// SPDX-License-Identifier: GPL-3.0-or-later
//
// Habits that all questions of the command line share: places that miss the terrain, geometries of
// another CRS, levels that nothing crosses, the words of a report.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>

#include "engine/geometry/affine.h"
#include "tests/tools/program.h"
#include "tools/facts/human.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

/// Hills of 240 x 240 samples of 500 m in EPSG:32611, from its middle meridian to the east.
std::string wide_hills(const TestFolder& folder) {
  testing::RasterRecipe recipe;
  recipe.width = recipe.height = 240;
  recipe.pixel = 500.0;
  recipe.value = [](int column, int row) {
    return 400 * std::sin(column / 9.0) * std::cos(row / 7.0) + row;
  };
  testing::make_raster(folder.file("wide.tif"), recipe);
  expect_done({"build", folder.file("wide.tif"), "-o", folder.file("wide.ptin"), "-q"});
  return folder.file("wide.ptin");
}

std::string small_plane(const TestFolder& folder, int epsg = 32611) {
  testing::RasterRecipe recipe;
  recipe.epsg = epsg;
  recipe.value = [](int column, int row) { return column + 10.0 * row; };
  testing::make_raster(folder.file("plane.tif"), recipe);
  expect_done({"build", folder.file("plane.tif"), "-o", folder.file("plane.ptin"), "-q"});
  return folder.file("plane.ptin");
}

MapPoint transformed(MapPoint p, int from, int to) {
  OGRSpatialReference a, b;
  a.importFromEPSG(from);
  b.importFromEPSG(to);
  for (OGRSpatialReference* crs : {&a, &b}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> way(OGRCreateCoordinateTransformation(&a, &b));
  EXPECT_TRUE(way->Transform(1, &p.x, &p.y));
  return p;
}

/// A layer in longitude and latitude.
void write_geojson(const std::string& path, const std::string& type, const json& coordinates) {
  write_file(path, json({{"type", "FeatureCollection"},
                         {"features",
                          {{{"type", "Feature"},
                            {"properties", json::object()},
                            {"geometry", {{"type", type}, {"coordinates", coordinates}}}}}}})
                       .dump());
}

/// `corners` and, between each two, `steps` places more at equal distances in degrees.
json along(const std::vector<MapPoint>& corners, int steps) {
  json path = json::array();
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    for (int k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      path.push_back({std::lerp(corners[i].x, corners[i + 1].x, t),
                      std::lerp(corners[i].y, corners[i + 1].y, t)});
    }
  }
  path.push_back({corners.back().x, corners.back().y});
  return path;
}

TEST(GeometriesOfAnotherCrs, BendAsTheirSidesDo) {
  const TestFolder folder;
  const std::string terrain = wide_hills(folder);
  const MapPoint a = transformed({505000, 3950000}, 32611, 4326);
  const MapPoint b = transformed({615000, 3952000}, 32611, 4326);
  const MapPoint c = transformed({560000, 3990000}, 32611, 4326);
  const std::string line = folder.file("line.geojson"), dense = folder.file("dense.geojson");
  write_geojson(line, "LineString", along({a, b}, 1));
  write_geojson(dense, "LineString", along({a, b}, 2000));
  const auto profile = [&](const std::string& of) {
    return answer_of(
        {"profile", terrain, "--line", of, "--stations", "1000", "--stations-only", "--json"});
  };
  const json few = profile(line), many = profile(dense);
  ASSERT_EQ(few.at("points").size(), many.at("points").size());
  double worst = 0.0;
  for (std::size_t i = 0; i < few.at("points").size(); ++i) {
    worst = std::max(worst, std::abs(few["points"][i]["height"].get<double>() -
                                     many["points"][i]["height"].get<double>()));
  }
  EXPECT_LT(worst, 1.0) << "hundreds of metres beside the line it was 20";
  EXPECT_EQ(few.at("transformed").at("from"), "WGS 84");
  EXPECT_NEAR(few.at("transformed").at("bent_at_most"), 5.0, 1e-3) << "a hundredth of 500 m";
  const Outcome told = run_ptin({"profile", terrain, "--line", line});
  EXPECT_NE(told.err.find("the lines, straight in WGS 84, went into the terrain's CRS with sides "
                          "that are off by 5 metre at most"),
            std::string::npos)
      << told.err;

  const std::string polygon = folder.file("p.geojson"), round = folder.file("d.geojson");
  write_geojson(polygon, "Polygon", json::array({along({a, b, c, a}, 1)}));
  write_geojson(round, "Polygon", json::array({along({a, b, c, a}, 2000)}));
  const auto area = [&](const std::string& of) {
    return answer_of({"volume", terrain, "--level", "0", "--polygon", of, "--json"});
  };
  const json sparse = area(polygon), full = area(round);
  const double exact = full.at("area").at("surface");
  EXPECT_NEAR(sparse.at("area").at("surface").get<double>() / exact, 1.0, 5e-4);
  EXPECT_TRUE(sparse.at("transformed").is_object());
  EXPECT_TRUE(answer_of({"volume", terrain, "--level", "0", "--json"}).at("transformed").is_null());
}

TEST(GeometriesOfAnotherCrs, LeaveEndsOfLinesOfSightAsTheyAre) {
  const TestFolder folder;
  const std::string terrain = wide_hills(folder);
  const MapPoint a = transformed({505000, 3950000}, 32611, 4326);
  const MapPoint b = transformed({615000, 3952000}, 32611, 4326);
  write_geojson(folder.file("s.geojson"), "LineString", {{a.x, a.y, 5000}, {b.x, b.y, 7000}});
  const json seen = answer_of({"sight", terrain, "--pairs", folder.file("s.geojson"), "--json"});
  EXPECT_EQ(seen.at("pairs").size(), 1u) << "a path of two points, with the heights of its z";
  EXPECT_EQ(seen.at("pairs")[0].at("verdict"), "visible");
}

TEST(PlacesOutside, AreWarnedOfWithWhatWasMeant) {
  const TestFolder folder;
  const std::string terrain = small_plane(folder);
  const auto warns = [&](const std::vector<std::string>& arguments, const std::string& words) {
    const Outcome outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << arguments[0] << ": " << outcome.err;
    std::vector<std::string> quiet = arguments;
    quiet.insert(quiet.begin() + 1, "-q");  // before a "--"
    EXPECT_EQ(run_ptin(quiet).err, "");
  };
  const std::string swapped = "with x and y exchanged some would: give x before y";
  warns({"locate", terrain, "3999500", "500500"}, swapped);
  warns({"profile", terrain, "--line", "LINESTRING(3999500 500500, 3999600 500600)"}, swapped);
  warns({"sight", terrain, "3999500", "500500", "2", "3999600", "500600", "2"}, swapped);
  write_file(folder.file("pairs.txt"), "3999500 500500 2 3999600 500600 2\n");
  warns({"sight", terrain, "--pairs", folder.file("pairs.txt")}, swapped);
  const MapPoint degrees = transformed({500500, 3999500}, 32611, 4326);
  const std::string lon = std::to_string(degrees.x), lat = std::to_string(degrees.y);
  warns({"locate", terrain, "--", lon, lat}, "as longitude and latitude some would");
  warns({"locate", terrain, "--", lat, lon}, "as latitude and longitude some would");
  warns({"locate", terrain, "0", "0"}, "which has x from 500015 to 500975");
  EXPECT_EQ(run_ptin({"locate", terrain, "500500", "3999500"}).err, "");
  write_file(folder.file("two.txt"), "500500 3999500\n0 0\n");
  EXPECT_EQ(run_ptin({"locate", terrain, "--points", folder.file("two.txt")}).err, "")
      << "one of them lies there";
}

TEST(Curvature, AboveOneIsRefusedAndRefractionIsAnotherSpelling) {
  const TestFolder folder;
  const std::string terrain = small_plane(folder);
  const auto sight = [&](const char* option, const char* value) {
    return run_ptin({"sight", terrain, "500100", "3999900", "2", "500900", "3999900", "2", option,
                     value, "--json"});
  };
  const Outcome beyond = sight("--curvature", "1.333");
  EXPECT_EQ(beyond.status, 2);
  EXPECT_NE(beyond.err.find("--refraction 1.333"), std::string::npos) << beyond.err;
  const auto clearance = [&](const char* option, const char* value) {
    const Outcome outcome = sight(option, value);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out).at("clearance").dump();
  };
  EXPECT_EQ(clearance("--refraction", "4/3"), clearance("--curvature", "0.75"));
  EXPECT_EQ(clearance("--refraction", "1"), clearance("--curvature", "1"));
  for (const char* none : {"0", "-1", "4/0", "x", "4/3/2", "nan", "1m"}) {
    EXPECT_EQ(sight("--refraction", none).status, 2) << none;
  }
}

TEST(Levels, OfAnIntervalThatNothingCrossesGiveAnEmptyLayer) {
  const TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.nodata = -9999.0;
  for (const double height : {13.0, -9999.0}) {
    recipe.value = [height](int, int) { return height; };
    testing::make_raster(folder.file("flat.tif"), recipe);
    const std::string store = folder.file("flat.ptin");
    expect_done({"build", folder.file("flat.tif"), "-o", store, "-q", "--overwrite"});
    for (const char* option : {"--interval", "--level"}) {
      const Outcome outcome = run_ptin(
          {"isoline", store, option, "10", "-o", folder.file("none.geojson"), "--overwrite"});
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_NE(outcome.err.find("no surface crosses these levels"), std::string::npos)
          << outcome.err;
    }
    if (height < 0) continue;
    expect_done({"isoline", store, "--interval", "10", "--polygons", "-o",
                 folder.file("bands.geojson"), "--overwrite", "-q"});
    expect_done({"stream", store, "-o", folder.file("flat.ptins"), "--overwrite", "-q"});
    expect_done({"unstream", folder.file("flat.ptins"), "--interval", "10", "-o",
                 folder.file("none.geojson"), "--overwrite", "-q"});
    expect_done({"volume", store, "--level", "10", "-q"});
    expect_done({"highest", store, "-q"});
  }
}

TEST(VolumeReport, SaysWhichFileIsWhichInNumbersThatCanBeRead) {
  const TestFolder folder;
  const std::string terrain = small_plane(folder);
  const Outcome level = run_ptin({"volume", terrain, "--level", "-100"});
  EXPECT_NE(level.out.find("cut   254,361,600 cubic metres: " + terrain +
                           " is above the level, material to take away\n"),
            std::string::npos)
      << level.out;
  const Outcome pit = run_ptin({"volume", terrain, "--against", terrain});
  EXPECT_NE(pit.out.find("fill  0 cubic metres: " + terrain + " is below " + terrain +
                         ", material to bring\n"),
            std::string::npos)
      << pit.out;
  EXPECT_EQ(grouped_number(83780376.2), "83,780,376.2");
  EXPECT_EQ(grouped_number(-1234.5), "-1,234.5");
  EXPECT_EQ(grouped_number(-123), "-123");
  EXPECT_EQ(grouped_number(0.125), "0.125");
  EXPECT_EQ(grouped_number(1e20), "1e+20");
  // With as many digits as are certain, and no more than people want.
  EXPECT_EQ(grouped_number(83780376.2, 0.01), "83,780,376");
  EXPECT_EQ(grouped_number(1234.56789, 1e-6), "1,234.568");
  EXPECT_EQ(grouped_number(1234.56789, 0.04), "1,234.6");
  EXPECT_EQ(grouped_number(-1234.56789, 20), "-1,235");
  EXPECT_EQ(grouped_number(0.0123456789, 1e-12), "0.012346");
  EXPECT_EQ(grouped_number(12.5, 0), "12.5");
  EXPECT_EQ(grouped_number(0, 1), "0");
  EXPECT_EQ(grouped_number(1e-9, 0), "1e-09");
  EXPECT_EQ(plural_of("US survey foot"), "US survey feet");
  EXPECT_EQ(plural_of("metre"), "metres");
}

TEST(SightCsv, HoldsTheFresnelZoneOfEachPair) {
  const TestFolder folder;
  const std::string terrain = small_plane(folder);
  const std::vector<std::string> ask = {"sight",  terrain,   "500100", "3999900",     "20",
                                        "500900", "3999900", "20",     "--frequency", "5GHz"};
  const Outcome csv = run_ptin(ask);
  EXPECT_NE(csv.out.find("fresnel_ratio,fresnel_x,fresnel_y,fresnel_distance,fresnel_height\n"),
            std::string::npos)
      << csv.out;
  std::vector<std::string> as_json = ask;
  as_json.emplace_back("--json");
  const json zone = answer_of(as_json).at("fresnel");
  std::string row;
  for (const char* name : {"ratio", "x", "y", "distance", "height"}) {
    row.append(",").append(exact_number(zone.at(name).get<double>()));
  }
  EXPECT_NE(csv.out.find(row + "\n"), std::string::npos) << row << "\n" << csv.out;
}

}  // namespace
}  // namespace ptin::tools
