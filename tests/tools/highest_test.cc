// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin highest end to end.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::run_ptin;

TEST(HighestProgram, FindsThePeakAndTellsOutsideFromVoid) {
  const testing::TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    if (column > 25) return -9999.0;
    return column == 7 && row == 5 ? 123.0 : 10.0 + column + row;
  };
  testing::make_raster(folder.file("r.tif"), recipe);
  const std::string file = folder.file("r.ptin");
  ASSERT_EQ(run_ptin({"build", folder.file("r.tif"), "-o", file, "-q"}).status, 0);
  const auto ask = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"highest", file, "--json"});
    const Outcome outcome = run_ptin(more);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  };
  const json peak = ask({"-k", "2"});
  EXPECT_EQ(peak.at("state"), "surface");
  EXPECT_EQ(peak.at("point").at("height"), 123.0);
  EXPECT_EQ(peak.at("point").at("x"), 500000.0 + 7.5 * 30);
  EXPECT_EQ(peak.at("point").at("y"), 4000000.0 - 5.5 * 30);
  EXPECT_EQ(peak.at("point").at("at_vertex"), true);
  EXPECT_EQ(peak.at("point").at("height_min"), 123.0);
  EXPECT_EQ(peak.at("certified_deviation"), 0.0);
  EXPECT_EQ(peak.at("exact"), true);
  ASSERT_EQ(peak.at("vertices").size(), 2U);
  EXPECT_EQ(peak.at("vertices").at(1).at("height"), 10.0 + 25 + 32);
  EXPECT_EQ(ask({"--lowest"}).at("point").at("height"), 10.0);
  EXPECT_EQ(ask({"--window", "500900", "3999500", "500950", "3999600"}).at("state"), "void");
  // Between samples: the border of the window holds the highest point.
  const json border = ask({"--window", "500100", "3999700", "500104", "3999702"});
  EXPECT_EQ(border.at("point").at("at_vertex"), false);
  EXPECT_TRUE(border.at("vertices").empty());
  EXPECT_EQ(run_ptin({"highest", file, "--window", "1", "0", "0", "1"}).status, 2);
  EXPECT_EQ(run_ptin({"highest", file, "-k", "0"}).status, 2);
}

/// The corner of an islet, which is cut off within the error: in the coarse TIN its window has no
/// surface, and so no highest point.
TEST(HighestProgram, HasNoPointWhereTheLevelIsVoid) {
  const testing::TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    const bool on_islet = column >= 20 && column <= 30 && row >= 6 && row <= 16;
    return column < 12 || on_islet ? testing::hills(column, row) : -9999.0;
  };
  testing::make_raster(folder.file("r.tif"), recipe);
  const std::string file = folder.file("r.ptin");
  testing::expect_done({"build", folder.file("r.tif"), "-o", file, "-q", "--void-slope", "0.1"});
  const std::vector<std::string> asked = {"highest", file,     "--window", "500880",
                                          "3999490", "500925", "3999540",  "--json"};
  EXPECT_EQ(testing::answer_of(asked).at("state"), "surface");
  std::vector<std::string> coarse = asked;
  coarse.insert(coarse.end(), {"--error", "60"});
  const json answer = testing::answer_of(coarse);
  EXPECT_EQ(answer.at("state"), "void");
  ASSERT_TRUE(answer.contains("point"));
  EXPECT_TRUE(answer.at("point").is_null()) << answer.at("point");
}

TEST(HighestProgram, SaysHowFarAFileThatIsNotExactMayBeOff) {
  const testing::TestFolder folder;
  testing::RasterRecipe recipe;
  recipe.value = [](int column, int row) { return (column * 7 + row * 13) % 5 + 0.25 * column; };
  testing::make_raster(folder.file("r.tif"), recipe);
  const auto highest = [&](const std::string& file, const std::vector<std::string>& options) {
    std::vector<std::string> build = {"build", folder.file("r.tif"), "-o", file, "-q"};
    build.insert(build.end(), options.begin(), options.end());
    EXPECT_EQ(run_ptin(build).status, 0);
    const Outcome outcome = run_ptin({"highest", file, "--json"});
    return json::parse(outcome.out, nullptr, false);
  };
  const json truth = highest(folder.file("all.ptin"), {});
  const json rough = highest(folder.file("rough.ptin"), {"--max-error", "3"});
  EXPECT_EQ(rough.at("exact"), false);
  EXPECT_GT(rough.at("certified_deviation").get<double>(), 0.0);
  const double height = truth.at("point").at("height").get<double>();
  EXPECT_LE(rough.at("point").at("height_min").get<double>(), height);
  EXPECT_GE(rough.at("point").at("height_max").get<double>(), height);
}

}  // namespace
}  // namespace ptin::tools
