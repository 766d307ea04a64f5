// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin build --breaklines` of lines without heights: they lie on the surface of the points.
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::expect_done;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;
using testing::write_file;

std::string layer_of(const std::vector<std::string>& wkts) {
  std::string text = "id,WKT\n";
  for (const std::string& wkt : wkts) text += "1,\"" + wkt + "\"\n";
  return text;
}

/// Steep hills at scattered places, and lines of every sort.
class DrapedLines : public ::testing::Test {
 protected:
  DrapedLines() {
    std::mt19937 random(4);
    std::string text = "x y z\n";
    for (int i = 0; i < 500; ++i) {
      const double x = double(random() % 20001) / 100, y = double(random() % 20001) / 100;
      const double z = std::round(6000 * std::sin(x / 30) + 5000 * std::cos(y / 20)) / 100;
      text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
    write_file(folder_.file("p.xyz"), text);
    // Two cross each other, one leaves the points, one is elsewhere.
    write_file(folder_.file("flat.csv"),
               layer_of({"LINESTRING (10.5 20.25,150 160,190 30)", "LINESTRING (20 150,180 40.5)",
                         "LINESTRING (-50 100,260 100.5)", "LINESTRING (300 300,310 310)"}));
    write_file(folder_.file("high.csv"), layer_of({"LINESTRING Z (60 50 7,90 120 9)"}));
    write_file(folder_.file("ring.csv"),
               layer_of({"POLYGON Z ((15 15 3,185 15 4,185 185 5,15 185 6,15 15 3))"}));
    write_file(folder_.file("flat_ring.csv"),
               layer_of({"POLYGON ((15 15,185 15,185 185,15 185,15 15))"}));
  }
  json built(const std::vector<std::string>& lines, const std::string& to,
             const std::string& threads = "2") const {
    std::vector<std::string> all = {"build",  folder_.file("p.xyz"), "-o",   folder_.file(to),
                                    "--json", "--threads",           threads};
    for (const std::string& l : lines) all.push_back(l.ends_with(".csv") ? folder_.file(l) : l);
    return answer_of(all);
  }
  TestFolder folder_;
};

TEST_F(DrapedLines, HaveTheHeightsOfThePoints) {
  const json plain = built({}, "plain.ptin");
  const json draped = built({"--breaklines", "flat.csv"}, "draped.ptin");
  EXPECT_GT(draped["vertices"], plain["vertices"]);
  EXPECT_EQ(draped["warnings"][0]["kind"], "draped_breaklines");
  EXPECT_EQ(draped["warnings"][0]["count"], 4);
  const auto along = [&](const std::string& store) {
    return answer_of({"profile", folder_.file(store), "--line",
                      "LINESTRING (10.5 20.25,150 160,190 30)", "--stations", "5", "--json"});
  };
  const json before = along("plain.ptin"), after = along("draped.ptin");
  const auto stations = [](const json& profile) {
    std::vector<json> heights;
    for (const json& p : profile["points"]) {
      if (p.value("station", false)) heights.push_back(p["height"]);
    }
    return heights;
  };
  const std::vector<json> on_points = stations(before), on_lines = stations(after);
  ASSERT_EQ(on_points.size(), on_lines.size());
  ASSERT_GT(on_points.size(), 50U);
  for (std::size_t i = 0; i < on_points.size(); ++i) {
    ASSERT_EQ(on_points[i].is_null(), on_lines[i].is_null());
    if (!on_points[i].is_null()) {
      EXPECT_NEAR(on_points[i].get<double>(), on_lines[i].get<double>(), 0.1) << i;
    }
  }
  // Vertices of the line are vertices of the terrain.
  const json there = answer_of({"locate", folder_.file("draped.ptin"), "150", "160", "--json"});
  bool is_vertex = false;
  for (const json& corner : there["points"][0]["triangle"])
    is_vertex = is_vertex || (corner[0] == 150.0 && corner[1] == 160.0);
  EXPECT_TRUE(is_vertex) << there;
}

TEST_F(DrapedLines, StandBesideLinesAndBoundariesOfEverySort) {
  for (const std::vector<std::string>& lines : std::vector<std::vector<std::string>>{
           {"--breaklines", "flat.csv"},
           {"--breaklines", "flat.csv", "high.csv"},
           {"--breaklines", "flat.csv", "--boundary", "flat_ring.csv"},
           {"--breaklines", "flat.csv", "high.csv", "--boundary", "flat_ring.csv"},
           {"--breaklines", "flat.csv", "high.csv", "--boundary", "ring.csv"}}) {
    SCOPED_TRACE(json(lines).dump());
    built(lines, "a.ptin", "1");
    built(lines, "b.ptin");
    EXPECT_EQ(read_file(folder_.file("a.ptin")), read_file(folder_.file("b.ptin")));
    std::vector<std::string> verify = {"verify", folder_.file("a.ptin"), "--against",
                                       folder_.file("p.xyz")};
    for (const std::string& l : lines) verify.push_back(l.ends_with(".csv") ? folder_.file(l) : l);
    const auto verified = run_ptin(verify);
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
    for (const char* name : {"a.ptin", "b.ptin"}) std::remove(folder_.file(name).c_str());
  }
}

}  // namespace
}  // namespace ptin::tools
