// SPDX-License-Identifier: GPL-3.0-or-later
//
// ptin viewshed end to end.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::run_ptin;

/// Flat ground of 10, 30 m pixels, with a wall of 100 across.
class ViewshedCommand : public ::testing::Test {
 protected:
  ViewshedCommand() {
    testing::RasterRecipe recipe;
    recipe.value = [](int column, int) { return column == 16 ? 100.0 : 10.0; };
    testing::make_raster(folder_.file("wall.tif"), recipe);
    const Outcome built =
        run_ptin({"build", folder_.file("wall.tif"), "-o", file_, "-q", "--overwrite"});
    EXPECT_EQ(built.status, 0) << built.err;
  }
  Outcome run(std::vector<std::string> more, const std::string& output) {
    more.insert(more.begin(), {"viewshed", file_, "500165", "3999685", "5", "--radius", "2000"});
    more.insert(more.end(), {"-o", folder_.file(output), "--overwrite", "--json"});
    return run_ptin(more);
  }
  json answer(const std::vector<std::string>& more, const std::string& output) {
    const Outcome outcome = run(more, output);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }

  testing::TestFolder folder_;
  std::string file_ = folder_.file("wall.ptin");
};

TEST_F(ViewshedCommand, EndsBehindAWallAndSaysThatItIsExact) {
  const json seen = answer({}, "seen.tif");
  EXPECT_EQ(seen.at("exact"), true);
  EXPECT_EQ(seen.at("certified_deviation"), 0.0);
  EXPECT_TRUE(seen.at("vertices").is_null());
  const int visible = seen.at("pixels").at("visible").get<int>();
  const int hidden = seen.at("pixels").at("hidden").get<int>();
  EXPECT_EQ(visible % 17, 0);  // columns 0 to 16
  EXPECT_EQ(hidden % 16, 0);   // the others
  EXPECT_EQ(visible / 17, hidden / 16);
  EXPECT_EQ(answer({}, "SEEN.TIF").at("pixels"), seen.at("pixels"));
  const json listed = answer({}, "seen.gpkg");
  EXPECT_TRUE(listed.at("pixels").is_null());
  EXPECT_EQ(listed.at("vertices").at("visible"), visible);
  EXPECT_EQ(listed.at("vertices").at("hidden"), hidden);
}

TEST_F(ViewshedCommand, BendsTheEarthAsSightDoesAndByTheSameDefault) {
  // Just over the wall: only the Earth's curvature hides its foot's far side.
  const std::vector<std::string> target = {"500165", "3999685", "90", "500885", "3999685", "90"};
  for (const std::string coefficient : {"", "0", "1"}) {
    std::vector<std::string> sight = {"sight", file_, "--json"};
    std::vector<std::string> view = {"--target-height", "90"};
    sight.insert(sight.begin() + 2, target.begin(), target.end());
    if (!coefficient.empty()) {
      sight.insert(sight.end(), {"--curvature", coefficient});
      view.insert(view.end(), {"--curvature", coefficient});
    }
    const json line = json::parse(run_ptin(sight).out, nullptr, false);
    view.insert(view.begin(), {"viewshed", file_, "500165", "3999685", "90", "--radius", "2000"});
    view.insert(view.end(), {"-o", folder_.file("b.tif"), "--overwrite", "--json"});
    const json seen = json::parse(run_ptin(view).out, nullptr, false);
    const bool all = seen.at("pixels").at("hidden") == 0;
    EXPECT_EQ(line.at("verdict") == "visible", all) << coefficient;
    EXPECT_EQ(all, coefficient == "0");
  }
}

TEST_F(ViewshedCommand, AtAnErrorIsNotExactAndSaysByHowMuch) {
  const json seen = answer({"--error", "95"}, "seen.tif");
  EXPECT_EQ(seen.at("exact"), false);
  EXPECT_GT(seen.at("certified_deviation").get<double>(), 0.0);
}

TEST_F(ViewshedCommand, CountsItsRasterBeforeItTakesIt) {
  const Outcome outcome = run({"--pixel-size", "0.1", "--memory", "64M"}, "seen.tif");
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_EQ(run({"--pixel-size", "0"}, "seen.tif").status, 2);
}

TEST_F(ViewshedCommand, KnowsItsFormatsBeforeItLooks) {
  for (const char* name : {"x.g", "x.", "x", "x.,"}) {
    const Outcome outcome = run_ptin({"viewshed", folder_.file("missing.ptin"), "0", "0", "5",
                                      "--radius", "20", "-o", folder_.file(name)});
    EXPECT_EQ(outcome.status, 2) << name << outcome.err;
    EXPECT_NE(outcome.err.find("the name must end in"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace ptin::tools
