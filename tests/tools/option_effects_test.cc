// SPDX-License-Identifier: GPL-3.0-or-later
//
// Options that do the same thing in another way, and options whose effect is a value in the output:
// each is seen to do it.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sched.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::built;
using testing::expect_done;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;

using Arguments = std::vector<std::string>;

Arguments together(Arguments command, const Arguments& more) {
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

class Options : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  /// A position within the bounds of a store.
  static std::array<std::string, 2> place(const std::string& store, double share_x,
                                          double share_y) {
    const json b = answer_of({"info", store, "--json"}).at("bounds");
    const auto between = [&](const char* low, const char* high, double share) {
      return std::to_string(b.at(low).get<double>() * (1 - share) +
                            b.at(high).get<double>() * share);
    };
    return {between("min_x", "max_x", share_x), between("min_y", "max_y", share_y)};
  }
  /// Hills, 65 x 65; the raster is hills.tif.
  [[nodiscard]] std::string built_hills() const {
    testing::RasterRecipe recipe;
    recipe.width = recipe.height = 65;
    testing::make_raster(file("hills.tif"), recipe);
    expect_done({"build", file("hills.tif"), "-o", file("hills.ptin"), "-q"});
    return file("hills.ptin");
  }
  TestFolder folder_;
};

/// What a question prints, and its output file.
struct Told {
  json answer;
  std::string file;
  bool operator==(const Told&) const = default;
};

class EveryIndexAndReader : public Options {
 protected:
  void expect_the_same(const Arguments& question) const {
    const Told expected = told(question, {});
    EXPECT_EQ(told(question, {"--no-mmap"}), expected) << question[0];
    Told of_other_tree = told(question, {"--index", "spatialindex"});
    EXPECT_GT(of_other_tree.answer.at("cost").at("index_nodes"), 0) << question[0];
    of_other_tree.answer["cost"] = expected.answer.at("cost");  // another tree has other nodes
    EXPECT_EQ(of_other_tree, expected) << question[0];
  }
  static Told told(const Arguments& question, const Arguments& more) {
    json answer = answer_of(together(together(question, more), {"--json"}));
    answer.at("cost").erase("seconds");
    const auto output = std::find(question.begin(), question.end(), "-o");
    return {answer, output == question.end() ? "" : read_file(*(output + 1))};
  }
  std::string store_ = built(folder_, "coast_257.tif");
  std::array<std::string, 2> a_ = place(store_, 0.2, 0.3), b_ = place(store_, 0.8, 0.6);
};

TEST_F(EveryIndexAndReader, FindsTheSameHeights) {
  expect_the_same({"locate", store_, b_[0], b_[1], "--error", "3"});
  const Arguments profile = {
      "profile",    store_,
      "--line",     "LINESTRING(" + a_[0] + " " + a_[1] + "," + b_[0] + " " + b_[1] + ")",
      "--vertices", "500"};
  EXPECT_EQ(told(profile, {"--no-mmap"}), told(profile, {}));  // of stars, which have one index
}

TEST_F(EveryIndexAndReader, FindsTheSamePeaksAndLines) {
  for (const Arguments& of_stars :
       {Arguments{"highest", store_, "--window", a_[0], a_[1], b_[0], b_[1], "-k", "20"},
        Arguments{"volume", store_, "--level", "100"}}) {
    EXPECT_EQ(told(of_stars, {"--no-mmap"}), told(of_stars, {})) << of_stars[0];
  }
  expect_the_same({"isoline", store_, "--interval", "50", "-o", file("i.fgb"), "--overwrite"});
}

TEST_F(EveryIndexAndReader, SeesTheSame) {
  expect_the_same({"sight", store_, a_[0], a_[1], "5", b_[0], b_[1], "300"});
  const json peak = answer_of({"highest", store_, "--json"}).at("point");
  expect_the_same({"viewshed", store_, peak.at("x").dump(), peak.at("y").dump(), "20", "--radius",
                   "3000", "--error", "2", "-o", file("v.tif"), "--overwrite"});
}

using StreamHave = Options;

TEST_F(StreamHave, SaysTheSameAsTheListOfServings) {
  const std::string store = built_hills();
  const auto low = place(store, 0.1, 0.2), high = place(store, 0.5, 0.7);
  const json heights = answer_of({"info", store, "--json"}).at("heights");
  const std::string level = std::to_string(
      std::floor((heights.at("min").get<double>() + heights.at("max").get<double>()) / 2));
  const Arguments window = {low[0], low[1], high[0], high[1]};
  struct Serving {
    const char* name;
    Arguments asked, had;
  };
  const std::vector<Serving> servings = {
      {"level", {"--level", level, "--error", "4"}, {"--have-level", level, "--have-error", "4"}},
      {"T0", {"--splits", "0"}, {"--have-splits", "0"}},
      {"all",
       together(together({"--window"}, window),
                {"--error", "3", "--level", level, "--splits", "50"}),
       together(together({"--have-window"}, window),
                {"--have-error", "3", "--have-level", level, "--have-splits", "50"})}};
  for (const Serving& s : servings) {
    SCOPED_TRACE(s.name);
    const Arguments overwritten = {"--overwrite", "--json"};
    const json first =
        answer_of(together(together({"stream", store, "-o", file("a.pts")}, s.asked), overwritten));
    const json has = answer_of({"unstream", file("a.pts"), "--json"}).at("have");
    const Arguments rest = {"stream", store, "--error", "1"};
    const json listed = answer_of(
        together(together(rest, {"--have", has.dump(), "-o", file("listed.pts")}), overwritten));
    const json said =
        answer_of(together(together(together(rest, s.had), {"-o", file("said.pts")}), overwritten));
    EXPECT_EQ(said.at("splits"), listed.at("splits"));
    EXPECT_EQ(said.at("base_vertices"), listed.at("base_vertices"));
    EXPECT_EQ(read_file(file("said.pts")), read_file(file("listed.pts")));
    const json whole = answer_of(together(
        {"unstream", file("a.pts"), file("said.pts"), "-o", file("whole.ply")}, overwritten));
    EXPECT_TRUE(whole.at("complete"));
    const auto count = [](const json& answer, const char* what) {
      return answer.at(what).get<int>();
    };
    EXPECT_EQ(count(said, "base_vertices"), count(first, "base_vertices") + count(first, "splits"));
    EXPECT_EQ(count(whole, "vertices"), count(said, "base_vertices") + count(said, "splits"));
  }
}

using IsolineLevels = Options;

TEST_F(IsolineLevels, AreCountedFromTheBase) {
  const std::string store = built(folder_, "mountains_257.tif");
  const auto asked = [&](const Arguments& levels) {
    const json answer = answer_of(
        together({"isoline", store, "-o", file("i.fgb"), "--overwrite", "--json"}, levels));
    return std::pair(answer.at("levels").get<std::vector<double>>(), read_file(file("i.fgb")));
  };
  const auto by_interval = asked({"--interval", "100", "--base", "37"});
  ASSERT_GT(by_interval.first.size(), 2U);
  Arguments listed = {"--level"};
  for (const double level : by_interval.first) {
    EXPECT_EQ(std::fmod(level, 100), 37);
    listed.push_back(std::to_string(level));
  }
  EXPECT_EQ(asked({"-i", "100", "--off", "37"}), by_interval) << "gdal_contour's name";
  EXPECT_EQ(asked(listed), by_interval);
  listed.front() = "--fl";
  EXPECT_EQ(asked(listed), by_interval) << "gdal_contour's name";
}

using BuildCosts = Options;

TEST_F(BuildCosts, OrderTheSameTerrainInAnotherWay) {
  static_cast<void>(built_hills());
  const std::string source = file("hills.tif");
  std::vector<std::string> contents;
  json first;
  for (const char* cost : {"error", "roi", "elevation"}) {
    SCOPED_TRACE(cost);
    const std::string store = file(std::string(cost) + ".ptin");
    expect_done({"build", source, "--cost", cost, "-o", store, "-q"});
    expect_done({"verify", store, "--against", source, "-q"});
    json info = answer_of({"info", store, "--json"});
    EXPECT_NE(info.at("metadata").dump().find(std::string("\"") + cost + "\""), std::string::npos)
        << info.at("metadata").dump();
    if (first.is_null()) first = info;
    EXPECT_EQ(info.at("vertices"), first.at("vertices"));
    EXPECT_EQ(info.at("bounds"), first.at("bounds"));
    contents.push_back(read_file(store));
  }
  EXPECT_NE(contents[0], contents[1]);
  EXPECT_NE(contents[0], contents[2]);
  EXPECT_NE(contents[1], contents[2]);
  EXPECT_EQ(run_ptin({"build", source, "--cost", "length", "-o", file("x.ptin")}).status, 2);
}

using BuildNodata = Options;

TEST_F(BuildNodata, IsAVoidThoughTheSourceDoesNotSaySo) {
  testing::RasterRecipe recipe;
  recipe.nodata = 55.0;  // what the source says, and what is overruled
  recipe.value = [](int column, int row) {
    return column < 4 && row < 5 ? -9999.0 : column == 9 ? 55.0 : 10.0;
  };
  testing::make_raster(file("t.tif"), recipe);
  const json as_said = answer_of({"build", file("t.tif"), "-o", file("a.ptin"), "--json"});
  EXPECT_EQ(as_said.at("void_samples"), 33);
  const json overruled =
      answer_of({"build", file("t.tif"), "--nodata", "-9999", "-o", file("b.ptin"), "--json"});
  EXPECT_EQ(overruled.at("void_samples"), 20);
  const json heights = answer_of({"info", file("b.ptin"), "--json"}).at("heights");
  EXPECT_EQ(heights.at("min"), 10.0);
  EXPECT_EQ(heights.at("max"), 55.0);
}

using BuildThreads = Options;

TEST_F(BuildThreads, AreThoseOfTheAffinity) {
  testing::RasterRecipe recipe;
  testing::make_raster(file("hills.tif"), recipe);
  int alone = 0, asked = 0;
  std::thread([&] {  // the affinity is a thread's own
    cpu_set_t given, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof given, &given), 0);
    int processor = 0;
    while (CPU_ISSET(processor, &given) == 0) ++processor;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    const Arguments plan = {"build",        file("hills.tif"), "-o",
                            file("t.ptin"), "--dry-run",       "--json"};
    alone = answer_of(plan).at("threads");
    asked = answer_of(together(plan, {"--threads", "2"})).at("threads");
  })
      .join();
  EXPECT_EQ(alone, 1);
  EXPECT_EQ(asked, 2);
}

using ExportNodata = Options;

TEST_F(ExportNodata, IsWrittenWhereThereIsNoSurfaceAndSaidInTheRaster) {
  testing::RasterRecipe recipe;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    return column < 4 && row < 5 ? -9999.0 : 10.0 + column;
  };
  testing::make_raster(file("t.tif"), recipe);
  expect_done({"build", file("t.tif"), "-o", file("t.ptin"), "-q"});
  for (const Arguments& more : {Arguments{}, Arguments{"--nodata", "-77.5"}}) {
    const double expected = more.empty() ? -9999.0 : -77.5;
    expect_done(
        together({"export", file("t.ptin"), "-o", file("e.tif"), "-q", "--overwrite"}, more));
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(file("e.tif").c_str()));
    ASSERT_NE(data, nullptr);
    GDALRasterBand* band = data->GetRasterBand(1);
    int has = 0;
    EXPECT_EQ(band->GetNoDataValue(&has), expected);
    EXPECT_EQ(has, 1);
    std::vector<double> values(33 * 33);
    ASSERT_EQ(
        band->RasterIO(GF_Read, 0, 0, 33, 33, values.data(), 33, 33, GDT_Float64, 0, 0, nullptr),
        CE_None);
    for (int row = 0; row < 33; ++row) {
      for (int column = 0; column < 33; ++column) {
        EXPECT_EQ(values[static_cast<std::size_t>(row * 33 + column)],
                  column < 4 && row < 5 ? expected : 10.0 + column);
      }
    }
  }
}

}  // namespace
}  // namespace ptin::tools
