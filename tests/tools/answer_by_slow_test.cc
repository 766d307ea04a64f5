// SPDX-License-Identifier: GPL-3.0-or-later
//
// `--by` heights, stars and splits of `ptin locate`, `isoline` and `sight`: three ways, one answer.
#include <algorithm>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/query/questions.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::expect_done;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;
using Arguments = std::vector<std::string>;

const std::vector<Arguments> kLevels = {{}, {"--error", "3"}, {"--vertices", "900"}};

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return text;
}

/// Hills with a lake without heights.
std::string hills_with_a_lake(const TestFolder& folder) {
  testing::RasterRecipe recipe;
  recipe.width = 70;
  recipe.height = 50;
  recipe.nodata = -9999.0;
  recipe.value = [](int x, int y) {
    const bool in_lake = (x - 20) * (x - 20) + (y - 20) * (y - 20) < 60;
    return in_lake ? -9999.0 : testing::hills(x, y);
  };
  testing::make_raster(folder.file("lake.tif"), recipe);
  expect_done({"build", folder.file("lake.tif"), "-o", folder.file("lake.ptin"), "-q"});
  return folder.file("lake.ptin");
}

/// Vertices, middles of edges and inner points of every `step`-th triangle of the TIN at an error,
/// and points on the border and outside.
std::vector<MapPoint> telling_points(const std::string& file, double error, std::size_t step) {
  const Terrain terrain = Terrain::open(file);
  const StoreFacts& facts = terrain.store().facts();
  RefineRequest request;
  request.detail.tolerance = error;
  const Tin tin = terrain.refine(request).tin;
  std::vector<MapPoint> points;
  for (TriangleId t = 0; t < tin.triangles.size(); t += static_cast<TriangleId>(step)) {
    const GridPoint a = tin.position(tin.triangles[t].v[0]);
    const GridPoint b = tin.position(tin.triangles[t].v[1]);
    const GridPoint c = tin.position(tin.triangles[t].v[2]);
    points.push_back(facts.map.to_map(a.x, a.y));
    points.push_back(facts.map.to_map((a.x + b.x) / 2.0, (a.y + b.y) / 2.0));
    points.push_back(facts.map.to_map((2.0 * a.x + b.x + c.x) / 4, (2.0 * a.y + b.y + c.y) / 4));
  }
  const GridBox& box = facts.bounds;
  const double middle = (box.min_y + box.max_y) / 2.0;
  for (const double x : {box.min_x - 1.0, box.min_x + 0.0, box.max_x + 0.0, box.max_x + 0.5})
    points.push_back(facts.map.to_map(x, middle));
  points.push_back(facts.map.to_map(box.max_x, box.max_y));
  return points;
}

/// The answer of `ptin locate` without its cost, which must be that of the way asked for.
json answer_by(const std::string& way, Arguments arguments) {
  arguments.insert(arguments.end(), {"--json", "--by", way});
  json answer = testing::answer_of(arguments);
  const json& cost = answer.at("cost");
  EXPECT_EQ(cost.at("records_applied").get<int>() > 0, way == "splits") << cost;
  if (std::find(arguments.begin(), arguments.end(), "--vertices") == arguments.end()) {
    EXPECT_EQ(cost.at("records_retrieved").get<int>() > 0, way == "splits") << cost;
  }  // else to find the last vertex of the level is to retrieve records
  EXPECT_EQ(cost.at("stars_read").get<int>() > 0, way == "stars") << cost;
  answer.erase("cost");
  return answer;
}

class AnswerByBothWays : public ::testing::TestWithParam<const char*> {
 protected:
  TestFolder folder_;
  std::string file_ = GetParam() == std::string("lake") ? hills_with_a_lake(folder_)
                                                        : testing::built(folder_, GetParam());
};

TEST_P(AnswerByBothWays, IsTheSameForManyPoints) {
  std::string text;
  for (const MapPoint& p : telling_points(file_, 3, 7))
    text += text_of(p.x) + "," + text_of(p.y) + "\n";
  write_file(folder_.file("p.csv"), text);
  std::set<std::string> states;
  for (const Arguments& level : kLevels) {
    Arguments asked = {"locate", file_, "--points", folder_.file("p.csv")};
    asked.insert(asked.end(), level.begin(), level.end());
    const json by_stars = answer_by("stars", asked);
    EXPECT_EQ(by_stars, answer_by("splits", asked));
    if (level.empty()) {
      EXPECT_EQ(by_stars, answer_by("heights", asked));
    }
    for (const json& point : by_stars.at("points")) states.insert(point.at("state"));
    const auto csv_by = [&](const char* way) {
      Arguments arguments = asked;
      arguments.insert(arguments.end(),
                       {"--by", way, "-o", folder_.file("a.csv"), "--overwrite", "-q"});
      expect_done(arguments);
      return read_file(folder_.file("a.csv"));
    };
    EXPECT_EQ(csv_by("stars"), csv_by("splits"));
    if (level.empty()) {
      EXPECT_EQ(csv_by("stars"), csv_by("heights"));
    }
  }
  EXPECT_TRUE(states.contains("surface") && states.contains("outside"));
  EXPECT_TRUE(states.contains("void") || GetParam() == std::string("mountains_257.tif"));
}

// A point by itself reads the pages of small errors first, and stops at the first triangle around
// it; many read the pages of their region.
TEST_P(AnswerByBothWays, IsTheSameForOnePoint) {
  const std::vector<MapPoint> points = telling_points(file_, 3, 1);
  for (const Arguments& level : kLevels) {
    for (std::size_t i = 0; i + 5 < points.size(); i += points.size() / 23) {
      Arguments asked = {"locate", file_, text_of(points[i].x), text_of(points[i].y)};
      asked.insert(asked.end(), level.begin(), level.end());
      const json by_stars = answer_by("stars", asked);
      EXPECT_EQ(by_stars, answer_by("splits", asked)) << asked[2] << " " << asked[3];
      if (level.empty()) {
        EXPECT_EQ(by_stars, answer_by("heights", asked)) << asked[2] << " " << asked[3];
      }
    }
  }
}

// Corners begin with the southernmost, of several the westernmost, and go around counter-clockwise.
TEST_P(AnswerByBothWays, NamesTrianglesFromTheirSouthernmostCorner) {
  const std::vector<MapPoint> points = telling_points(file_, 3, 1);
  const MapPoint& inner = points[(points.size() / 6) * 3 + 2];
  for (const char* way : {"heights", "stars", "splits"}) {
    const json answer = answer_by(way, {"locate", file_, text_of(inner.x), text_of(inner.y)});
    const json& corners = answer.at("points").at(0).at("triangle");
    const auto at = [&](std::size_t i) { return corners.at(i).at(0).get<double>(); };
    const auto north = [&](std::size_t i) { return corners.at(i).at(1).get<double>(); };
    for (const std::size_t i : {1U, 2U})
      EXPECT_TRUE(north(0) < north(i) || (north(0) == north(i) && at(0) < at(i))) << corners;
    EXPECT_GT((at(1) - at(0)) * (north(2) - north(0)) - (at(2) - at(0)) * (north(1) - north(0)), 0)
        << corners;
  }
}

TEST_P(AnswerByBothWays, IsTheSameForIsolines) {
  const std::vector<Arguments> asked = {{"--interval", "7"},
                                        {"--interval", "20", "--error", "3"},
                                        {"--interval", "20", "--vertices", "900"}};
  for (const Arguments& options : asked) {
    std::vector<std::string> layers;
    for (const char* way : {"stars", "splits", "heights"}) {
      if (way == std::string("heights") && options.size() > 2) continue;  // of the full TIN alone
      Arguments arguments = {"isoline", file_, "--by", way, "--3d", "--json", "--overwrite"};
      arguments.insert(arguments.end(), {"-o", folder_.file("a.geojson")});
      arguments.insert(arguments.end(), options.begin(), options.end());
      const json answer = testing::answer_of(arguments);
      EXPECT_GT(answer.at("lines"), 0);
      EXPECT_EQ(answer.at("cost").at("stars_read") > 0, way == std::string("stars"));
      EXPECT_EQ(answer.at("cost").at("records_applied") > 0, way == std::string("splits"));
      layers.push_back(read_file(folder_.file("a.geojson")));
    }
    for (const std::string& layer : layers) EXPECT_EQ(layer, layers[0]);
  }
}

// Lines between vertices, middles of edges, inner points, and points outside and on the border.
TEST_P(AnswerByBothWays, IsTheSameForLinesOfSight) {
  const std::vector<MapPoint> points = telling_points(file_, 3, 1);
  const std::size_t step = points.size() / 23;
  std::string text;
  for (std::size_t i = 0; i + step < points.size(); i += step) {
    for (const char* height : {"0", "2", "150"}) {
      const MapPoint& a = points[i];
      const MapPoint& b = points[(i * 7 + 5) % points.size()];
      text += text_of(a.x) + " " + text_of(a.y) + " " + height + " " + text_of(b.x) + " " +
              text_of(b.y) + " " + height + "\n";
    }
  }
  write_file(folder_.file("pairs.txt"), text);
  std::set<json> verdicts;
  for (const Arguments& more :
       std::vector<Arguments>{{}, {"--absolute"}, {"--frequency", "1GHz"}}) {
    const auto pairs_by = [&](const char* way) {
      Arguments asked = {"sight",  file_,  "--pairs", folder_.file("pairs.txt"),
                         "--json", "--by", way};
      asked.insert(asked.end(), more.begin(), more.end());
      json pairs = testing::answer_of(asked).at("pairs");
      for (json& pair : pairs) {
        EXPECT_EQ(
            pair.at("cost").at(way == std::string("stars") ? "records_retrieved" : "stars_read"),
            0);
        pair.erase("cost");
        verdicts.insert(pair.at("verdict"));
      }
      return pairs;
    };
    const json by_stars = pairs_by("stars");
    const json by_splits = pairs_by("splits");
    ASSERT_EQ(by_stars.size(), by_splits.size());
    for (std::size_t i = 0; i < by_stars.size(); ++i) {
      EXPECT_EQ(by_stars.at(i), by_splits.at(i)) << i;
    }
  }
  EXPECT_TRUE(verdicts.contains("hidden") && verdicts.contains("visible"));
}

INSTANTIATE_TEST_SUITE_P(Terrains, AnswerByBothWays,
                         ::testing::Values("coast_257.tif", "mountains_257.tif", "lake"),
                         [](const auto& of) {
                           const std::string name = of.param;
                           return name.substr(0, name.find('_'));
                         });

TEST(AnswerBy, IsHeightsOfTheFullTinAndStarsOfLevels) {
  const TestFolder folder;
  const std::string file = testing::small_store(folder);
  for (const Arguments& level : {Arguments{}, {"--error", "3"}, {"--vertices", "100"}}) {
    Arguments asked = {"locate", file, "500500", "3999500", "--json"};
    asked.insert(asked.end(), level.begin(), level.end());
    const json answer = testing::answer_of(asked);
    EXPECT_EQ(answer.at("cost").at("stars_read") > 0, !level.empty());
    EXPECT_GT(answer.at("cost").at("pages"), 0);
    EXPECT_EQ(answer.at("cost").at("records_applied"), 0);
  }
}

TEST(AnswerBy, HeightsAreRefusedWhereTheyCannotAnswer) {
  const TestFolder folder;
  const std::string file = testing::small_store(folder);
  Arguments asked = {"locate", file, "500500", "3999500", "--by", "heights"};
  EXPECT_EQ(run_ptin(asked).status, 0);
  asked.insert(asked.end(), {"--error", "0"});
  testing::expect_refusal(run_ptin(asked), 2, "a level of detail is asked for");
  asked = {"locate", file, "500500", "3999500", "--by", "heights", "--index", "spatialindex"};
  testing::expect_refusal(run_ptin(asked), 2, "heights are found without an index");
  write_file(folder.file("p.csv"), "x,y,z\n0,0,1\n40,0,2\n20,40,3\n20,20,9\n");
  expect_done(
      {"build", folder.file("p.csv"), "--resolution", "1", "-o", folder.file("p.ptin"), "-q"});
  for (const Arguments& question : std::vector<Arguments>{
           {"locate", folder.file("p.ptin"), "20", "10"},
           {"sight", folder.file("p.ptin"), "20", "10", "1", "20", "15", "1"},
           {"isoline", folder.file("p.ptin"), "-i", "1", "-o", folder.file("l.geojson")}}) {
    Arguments by_heights = question;
    by_heights.insert(by_heights.end(), {"--by", "heights"});
    testing::expect_refusal(run_ptin(by_heights), 2, "has no heights of a raster");
  }
}

TEST(AnswerBy, AnotherWayIsRefused) {
  const TestFolder folder;
  const std::string file = testing::small_store(folder);
  testing::expect_refusal(run_ptin({"locate", file, "500500", "3999500", "--by", "sideways"}), 2,
                          "--by");
  EXPECT_EQ(run_ptin({"locate", file, "500500", "3999500", "--by", "Splits"}).status, 0);
}

}  // namespace
}  // namespace ptin::tools
