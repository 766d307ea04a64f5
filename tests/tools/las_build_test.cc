// SPDX-License-Identifier: GPL-3.0-or-later
//
// `ptin build` over LAS: heights in their unit, silence where it is asked for, digits that no grid
// keeps.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/las_file.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::answer_of;
using testing::expect_done;
using testing::run_ptin;
using testing::spawn_ptin;
using testing::TestFolder;
using testing::write_file;

std::string keys(const std::vector<std::uint16_t>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * 2};
}

LasFileMaker plane(const std::vector<std::uint16_t>& directory) {
  LasFileMaker las;
  las.records = {{34735, keys(directory)}};
  las.scale = {0.01, 0.01, 0.1};
  for (int i = 0; i < 121; ++i) {
    las.points.push_back({1000 * (i % 11), 1000 * (i / 11), 100 * (i % 11)});
  }
  return las;
}

nlohmann::json info_of(const TestFolder& folder, const std::vector<std::uint16_t>& directory) {
  write_file(folder.file("a.las"), plane(directory).bytes());
  expect_done({"build", folder.file("a.las"), "-o", folder.file("a.ptin"), "--overwrite", "-q"});
  return answer_of({"info", folder.file("a.ptin"), "--json"});
}

TEST(LasBuild, KnowsTheUnitOfHeightsBesideOrWithoutAVerticalCrs) {
  const TestFolder folder;
  const auto feet =
      info_of(folder, {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32617, 4099, 0, 1, 9003});
  EXPECT_EQ(feet["units"]["height"], "US survey foot");
  EXPECT_FALSE(feet["crs"]["vertical_known"]);
  EXPECT_EQ(feet["crs"]["code"], "EPSG:32617");
  const auto navd88 = info_of(
      folder, {1, 1, 0, 4, 1024, 0, 1, 1, 3072, 0, 1, 32617, 4096, 0, 1, 5703, 4099, 0, 1, 9001});
  EXPECT_EQ(navd88["units"]["height"], "metre");
  EXPECT_EQ(navd88["crs"]["vertical_code"], "EPSG:5703");
  const auto both = info_of(
      folder, {1, 1, 0, 4, 1024, 0, 1, 1, 3072, 0, 1, 32617, 4096, 0, 1, 5703, 4099, 0, 1, 9003});
  EXPECT_EQ(both["units"]["height"], "US survey foot");
  EXPECT_EQ(both["crs"]["vertical_name"], "NAVD88 height (ftUS)");
  const auto above_ellipsoid = info_of(
      folder, {1, 1, 0, 4, 1024, 0, 1, 1, 3072, 0, 1, 32617, 4096, 0, 1, 5030, 4099, 0, 1, 9001});
  EXPECT_EQ(above_ellipsoid["units"]["height"], "metre");
  EXPECT_EQ(above_ellipsoid["crs"]["vertical_known"], true) << above_ellipsoid["crs"];
}

// A unit that libgeotiff asks PROJ for, in a context of its own.
TEST(LasBuild, PrintsNothingWhenItIsToBeQuiet) {
  const TestFolder folder;
  write_file(folder.file("a.las"),
             plane({1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 32617, 3076, 0, 1, 32632}).bytes());
  const auto outcome =
      spawn_ptin({"build", folder.file("a.las"), "-o", folder.file("a.ptin"), "-q"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.err, "");
}

// The last digit is a 5 that is dropped: in the middle of two steps.
TEST(LasBuild, VerifyKnowsWhichDigitsWereDropped) {
  const TestFolder folder;
  std::string text;
  for (int i = 0; i < 60; ++i) {
    text += std::to_string(i % 8 * 137) + ".12345" + std::to_string(i % 10) + "5 " +
            std::to_string(i / 8 * 131) + ".00000" + std::to_string(i % 7) + "5 " +
            std::to_string(i) + "\n";
  }
  text += "1000.5 1000.5 3\n";
  write_file(folder.file("a.xyz"), text);
  const auto built =
      answer_of({"build", folder.file("a.xyz"), "-o", folder.file("a.ptin"), "--json"});
  EXPECT_GT(built["largest_shift"]["plan"], 0.0);
  EXPECT_LT(built["largest_shift"]["plan"], 1e-5);
  const auto outcome =
      run_ptin({"verify", folder.file("a.ptin"), "--against", folder.file("a.xyz"), "-q"});
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
}

TEST(LasBuild, WarnsOfPointsFarFromAllOthersAndOfHeightsThatMeanNone) {
  const TestFolder folder;
  std::string text;
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(500000 + i % 10) + " " + std::to_string(4000000 + i / 10) + " " +
            (i % 50 == 7 ? std::string("-9999") : std::to_string(100 + i)) + "\n";
  }
  write_file(folder.file("a.xyz"), text + "0 0 0\n");
  const auto outcome =
      run_ptin({"build", folder.file("a.xyz"), "-o", folder.file("a.ptin"), "--overwrite"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("at 0 0 0"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("--nodata -9999"), std::string::npos) << outcome.err;
}

TEST(LasBuild, RefusesTerrainsThatWouldReachAroundTheWorld) {
  const TestFolder folder;
  std::string text;
  for (int i = 0; i < 100; ++i) {
    const int x = i % 10;
    text += (x < 5 ? "179." + std::to_string(x) : "-179." + std::to_string(x)) + " -17." +
            std::to_string(i / 10) + " 5\n";
  }
  write_file(folder.file("a.xyz"), text);
  const auto outcome = run_ptin(
      {"build", folder.file("a.xyz"), "--a-srs", "EPSG:4326", "-o", folder.file("a.ptin")});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("add 360"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace ptin::tools
