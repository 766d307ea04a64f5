// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ids of points, pairs and lines in the answers of locate, sight and profile.
#include <map>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <ogrsf_frmts.h>

#include "tests/tools/program.h"
#include "tests/tools/wall_terrain.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::east;
using testing::Outcome;
using testing::run_ptin;
using testing::south;
using testing::TestFolder;
using testing::wall;
using testing::write_file;

/// The contents of a layer: its name, its CRS, and of each feature the attributes and the geometry.
struct ReadLayer {
  std::string name, crs;
  std::vector<std::map<std::string, std::string>> features;  ///< null attributes left out
  std::vector<std::string> geometries;
};

ReadLayer layer_in(const std::string& path) {
  const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  ReadLayer read;
  if (data == nullptr || data->GetLayerCount() != 1) {
    ADD_FAILURE() << path;
    return read;
  }
  OGRLayer& layer = *data->GetLayer(0);
  read.name = layer.GetName();
  if (layer.GetSpatialRef() != nullptr) read.crs = layer.GetSpatialRef()->GetAuthorityCode(nullptr);
  for (const auto& feature : layer) {
    auto& attributes = read.features.emplace_back();
    for (int i = 0; i < feature->GetFieldCount(); ++i) {
      if (feature->IsFieldSetAndNotNull(i) != 0)
        attributes[feature->GetFieldDefnRef(i)->GetNameRef()] = feature->GetFieldAsString(i);
    }
    read.geometries.push_back(feature->GetGeometryRef()->exportToWkt());
  }
  return read;
}

TEST(Ids, TravelToTheAnswerOfLocate) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const std::string points = folder.file("wells.csv");
  write_file(points, "x,y,well,code\n" + east(15.5) + "," + south(20) + ",\"A, \"\"b\"\"\",7\n" +
                         east(31) + "," + south(1) + ",,8\n0,0,C,9\n");
  const std::vector<std::string> question = {"locate", terrain, "--points", points};
  const auto asked = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = question;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_ptin(arguments);
  };
  const std::string table = asked({}).out;
  EXPECT_EQ(table.substr(0, table.find('\n')), "x,y,state,height,height_min,height_max,id");
  EXPECT_NE(table.find("surface,55,55,55,\"A, \"\"b\"\"\"\n"), std::string::npos) << table;
  EXPECT_NE(table.find("void,,,,\n0,0,outside,,,,C\n"), std::string::npos) << table;
  const json answer = json::parse(asked({"--json", "--id", "CODE"}).out);
  EXPECT_EQ(answer.at("points").at(2).at("id"), "9");
  EXPECT_TRUE(answer.at("output").is_null());
  for (const char* output : {"a.gpkg", "a.geojson", "a.fgb"}) {
    EXPECT_EQ(asked({"-o", folder.file(output)}).out, "") << output;
    const ReadLayer layer = layer_in(folder.file(output));
    EXPECT_EQ(layer.crs, "32611");
    ASSERT_EQ(layer.features.size(), 3u) << output;
    std::size_t surface = 0;
    while (layer.features.at(surface).at("state") != "surface") ++surface;  // FlatGeobuf sorts
    EXPECT_EQ(layer.features[surface].at("id"), "A, \"b\"");
    EXPECT_EQ(layer.features[surface].at("height"), "55");
    EXPECT_EQ(layer.geometries[surface].substr(0, 12), "POINT (50048");
    for (const auto& feature : layer.features) {
      EXPECT_EQ(feature.count("height"), feature.at("state") == "surface" ? 1u : 0u);
    }
  }
  EXPECT_EQ(asked({"-o", folder.file("a.csv")}).out, "");
  EXPECT_EQ(testing::read_file(folder.file("a.csv")), table);
  EXPECT_EQ(asked({"-o", folder.file("a.csv")}).status, 2) << "it is there";
  EXPECT_EQ(asked({"-o", points, "--overwrite"}).status, 2) << "an input";
  EXPECT_EQ(asked({"-o", folder.file("a.doc")}).status, 2);
  EXPECT_EQ(asked({"-o", "-", "--json"}).status, 2);
  EXPECT_EQ(json::parse(asked({"-o", "-"}).out).at("features").size(), 3u);
  const Outcome none = asked({"--id", "depth"});
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("no column 'depth'; there are 'x', 'y', 'well', 'code'"),
            std::string::npos)
      << none.err;
}

TEST(Ids, TravelToTheAnswersOfSightAndProfile) {
  const TestFolder folder;
  const std::string terrain = wall(folder);
  const auto link = [](double row, const std::string& height) {
    return east(4) + "," + south(row) + "," + height + "," + east(28) + "," + south(row) + "," +
           height + "\n";
  };
  const std::string pairs = folder.file("links.csv"), links = folder.file("links.gpkg");
  write_file(pairs,
             "link,x1,y1,h1,x2,y2,h2\nA1," + link(20, "5") + "\"B \"\"2\"\"\"," + link(22, "200"));
  const Outcome table = run_ptin({"sight", terrain, "--pairs", pairs});
  EXPECT_EQ(table.out.find("verdict,length,"), 0u) << table.err;
  EXPECT_NE(table.out.find(",A1\n"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find(",\"B \"\"2\"\"\"\n"), std::string::npos) << table.out;
  const json answer = answer_of({"sight", terrain, "--pairs", pairs, "-o", links, "--json"});
  EXPECT_EQ(answer.at("pairs").at(1).at("id"), "B \"2\"");
  EXPECT_EQ(answer.at("output"), links);
  const ReadLayer seen = layer_in(links);
  ASSERT_EQ(seen.features.size(), 2u);
  EXPECT_EQ(seen.features[0].at("verdict"), "hidden");
  EXPECT_EQ(seen.features[0].at("id"), "A1");
  EXPECT_EQ(seen.features[1].at("verdict"), "visible");
  EXPECT_EQ(seen.features[1].count("obstruction_x"), 0u);
  EXPECT_EQ(seen.geometries[0].find("LINESTRING (500135"), 0u) << seen.geometries[0];
  testing::expect_done({"sight", terrain, "--pairs", pairs, "-o", folder.file("seen.csv")});
  EXPECT_EQ(testing::read_file(folder.file("seen.csv")), table.out);

  const std::vector<std::string> question = {"profile", terrain, "--line", links};
  const auto profiled = [&](const std::string& output) {
    std::vector<std::string> arguments = question;
    arguments.insert(arguments.end(), {"--id", "id", "-o", folder.file(output)});
    testing::expect_done(arguments);
    return folder.file(output);
  };
  const std::string heights = testing::read_file(profiled("p.csv"));
  EXPECT_NE(heights.find(",id\n"), std::string::npos) << heights;
  EXPECT_NE(heights.find(",0,10,10,A1\n"), std::string::npos) << heights;
  EXPECT_NE(heights.find(",1,10,10,\"B \"\"2\"\"\"\n"), std::string::npos) << heights;
  for (const char* output : {"p.gpkg", "p.geojson"}) {
    const ReadLayer layer = layer_in(profiled(output));
    ASSERT_EQ(layer.features.size(), 2u) << output;
    EXPECT_EQ(layer.features[1].at("id"), "B \"2\"");
    EXPECT_EQ(layer.features[1].at("length"), "720");
    EXPECT_NE(layer.geometries[1].find(" 100,"), std::string::npos) << "the wall's height";
  }
  const json by_default = answer_of({"profile", terrain, "--line", links, "--json"});
  EXPECT_EQ(by_default.at("ids"), json({"hidden", "visible"})) << "the first text";
  const Outcome none = run_ptin({"profile", terrain, "--line", links, "--id", "road"});
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("no attribute 'road'"), std::string::npos) << none.err;
}

TEST(Ids, AreNeverTimesOrMeasuresByThemselves) {
  const TestFolder folder;
  const std::string terrain = testing::built(folder, "coast_257.tif");
  const std::string tour = folder.file("tour.gpx");
  write_file(tour, R"(<?xml version="1.0"?><gpx version="1.1" creator="test" )"
                   R"(xmlns="http://www.topografix.com/GPX/1/1"><wpt lat="48.46" lon="-124.2">)"
                   R"(<ele>5</ele><time>2026-01-01T00:00:00Z</time><name>Camp</name></wpt></gpx>)");
  const auto id = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"locate", terrain, "--points", tour, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments).at("points").at(0).at("id");
  };
  EXPECT_EQ(id({}), "Camp");
  EXPECT_EQ(id({"--id", "ele"}), "5");
  EXPECT_EQ(id({"--id", "FID"}), "0");
}

}  // namespace
}  // namespace ptin::tools
