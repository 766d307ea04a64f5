// SPDX-License-Identifier: GPL-3.0-or-later
//
// What ptin refine says that it wrote.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"
#include "tools/facts/human.h"

namespace ptin::tools {
namespace {

using testing::run_ptin;
using testing::TestFolder;

/// Half of it void.
std::string terrain_with_voids(const TestFolder& folder) {
  testing::RasterRecipe recipe;
  recipe.nodata = -9999.0;
  recipe.value = [](int column, int row) {
    return column > 14 && row > 3 ? -9999.0 : testing::hills(column, row);
  };
  testing::make_raster(folder.file("voids.tif"), recipe);
  testing::expect_done({"build", folder.file("voids.tif"), "-o", folder.file("voids.ptin"), "-q"});
  return folder.file("voids.ptin");
}

/// The number before a noun.
std::size_t count_in(const std::string& text, const std::string& noun) {
  const std::size_t end = text.find(" " + noun);
  const std::size_t begin = text.find_last_of(" ", end - 1) + 1;
  std::string digits = text.substr(begin, end - begin);
  std::erase(digits, ',');
  return std::stoul(digits);
}

TEST(RefineProgram, AlwaysSaysWhatItWrote) {
  const TestFolder folder;
  const std::string store = terrain_with_voids(folder);
  const std::string out = folder.file("a.ply");
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"refine", store, "--overwrite", "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  const auto written = [&] { return testing::read_ply(testing::read_file(out)); };
  for (const std::vector<std::string>& more : {std::vector<std::string>{},
                                               {"--error", "5"},
                                               {"--vertices", "300"},
                                               {"--triangles", "300"}}) {
    const std::string text = said(more);
    EXPECT_TRUE(text.starts_with(out + ": ")) << text;
    EXPECT_EQ(count_in(text, "vertices"), written().vertices.size());
    EXPECT_EQ(count_in(text, "triangles written"), written().triangles.size());
    const auto answer = testing::answer_of([&] {
      std::vector<std::string> all = {"refine", store, "--overwrite", "-o", out, "--json"};
      all.insert(all.end(), more.begin(), more.end());
      return all;
    }());
    EXPECT_EQ(answer.at("written").at("vertices"), written().vertices.size());
    const bool is_number_asked = !more.empty() && more[0] != "--error";
    EXPECT_LE(testing::lines_in(text), is_number_asked ? 2U : 1U) << text;
  }
  EXPECT_EQ(said({"-q"}), "");
  EXPECT_GT(testing::lines_in(said({"--stats"})), 2U);
}

/// A level of detail has void vertices and triangles too, which no format holds.
TEST(RefineProgram, SaysWhyItWroteAnotherNumberThanWasAskedFor) {
  const TestFolder folder;
  const std::string store = terrain_with_voids(folder);
  const std::string out = folder.file("a.ply");
  const auto difference = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"refine", store, "--overwrite", "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = run_ptin(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const std::size_t line = outcome.out.find('\n') + 1;
    return outcome.out.substr(line);
  };
  const auto mesh = [&] { return testing::read_ply(testing::read_file(out)); };
  const std::string few = difference({"--vertices", "1000"});
  EXPECT_EQ(few, "  asked for  1,000 vertices; " + std::to_string(1000 - mesh().vertices.size()) +
                     " in void triangles alone are left out\n");
  const std::string all = difference({"--vertices", "5000"});
  EXPECT_TRUE(all.starts_with("  asked for  5,000 vertices; the terrain has 1,089; ")) << all;
  const std::string faces = difference({"--triangles", "301"});
  EXPECT_TRUE(faces.starts_with("  asked for  at most 301 triangles; ")) << faces;
  EXPECT_TRUE(faces.ends_with(" void ones are left out\n")) << faces;
  const std::string part = difference(
      {"--vertices", "300", "--clip", "--window", "500100", "3999600", "500300", "3999800"});
  EXPECT_EQ(part, "  asked for  300 vertices; the region's part of that mesh is written\n");
  // Without voids everything is written.
  testing::make_raster(folder.file("hills.tif"), {});
  const std::string hills = folder.file("hills.ptin");
  testing::expect_done({"build", folder.file("hills.tif"), "-o", hills, "-q"});
  const auto whole = run_ptin({"refine", hills, "--overwrite", "--vertices", "300", "-o", out});
  EXPECT_EQ(whole.out,
            out + ": 300 vertices, " + grouped(mesh().triangles.size()) + " triangles written\n");
  for (const char* n : {"200", "201", "202"}) {
    const auto outcome = run_ptin({"refine", hills, "--overwrite", "--triangles", n, "-o", out});
    const std::size_t made = mesh().triangles.size();
    EXPECT_TRUE(made == std::stoul(n) || made + 1 == std::stoul(n)) << made;
    EXPECT_EQ(outcome.out.find("; the next vertex adds two\n") != std::string::npos,
              made != std::stoul(n))
        << outcome.out;
  }
}

}  // namespace
}  // namespace ptin::tools
