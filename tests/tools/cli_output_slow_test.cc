// SPDX-License-Identifier: GPL-3.0-or-later
//
// Outputs of every format on a disk that is full, and answers that standard output does not take, of the program as it is
// installed: one clear sentence, and nothing left behind.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/test_folder.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using test::SmallDisk;
using testing::expect_refusal;
using testing::Outcome;
using testing::run_ptin;
using testing::small_store;
using testing::test_data;
using testing::TestFolder;

TEST(CliBadInput, AnswerThatStdoutDoesNotTake) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const std::string line = "LINESTRING(500100 3999900, 500700 3999300)";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", store},
        {"info", store, "--json"},
        {"locate", store, "500100", "3999900"},
        {"profile", store, "--line", line},
        {"profile", store, "--line", line, "-o", "-"},
        {"sight", store, "500100", "3999900", "2", "500700", "3999300", "2"},
        {"highest", store},
        {"volume", store, "--level", "1"},
        {"isoline", store, "--interval", "1", "-o", "-", "-q"},
        {"stream", store, "-o", "-"},
        {"verify", store, "-q", "--json"},
        {"completion", "bash"},
        {"--help"},
        {"--version"}}) {
    const Outcome outcome = testing::spawn_ptin_into("/dev/full", arguments);
    EXPECT_EQ(outcome.status, 7) << arguments[0];
    EXPECT_NE(outcome.err.find("standard output"), std::string::npos)
        << arguments[0] << outcome.err;
  }
}

TEST(CliBadInput, FullDisk) {
  const TestFolder folder;
  const SmallDisk disk(folder.file("disk"), 1);
  if (!disk.is_mounted()) GTEST_SKIP() << SmallDisk::kNeeded;
  const std::string store = testing::built(folder, "mountains_257.tif");
  expect_refusal(
      run_ptin({"build", test_data("mountains_257.tif"), "-o", disk.path() + "/m.ptin", "-q"}), 7,
      "m.ptin");
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
  for (const char* name : {"/a.ply", "/a.obj", "/a.2dm", "/a.glb", "/a.xml", "/a.dxf", "/a.stl"}) {
    expect_refusal(run_ptin({"refine", store, "-o", disk.path() + name}), 7, name);
    EXPECT_TRUE(std::filesystem::is_empty(disk.path())) << name;
  }
  for (const char* name : {"/a.ply", "/a.xml", "/a.dxf", "/a.stl", "/a.gpkg", "/a.fgb", "/a.tif"}) {
    std::vector<std::string> arguments = {"export", store, "-q", "-o", disk.path() + name};
    if (name == std::string("/a.tif")) arguments.insert(arguments.end(), {"--pixel-size", "8"});
    expect_refusal(run_ptin(arguments), 7, name);
    EXPECT_TRUE(std::filesystem::is_empty(disk.path())) << name;
  }
  for (const char* name : {"/a.gpkg", "/a.fgb", "/a.geojson", "/a.shp", "/a.dxf", "/a.xml"}) {
    expect_refusal(run_ptin({"isoline", store, "--interval", "5", "-q", "-o", disk.path() + name}),
                   7, name);
    EXPECT_TRUE(std::filesystem::is_empty(disk.path())) << name;
  }
  expect_refusal(
      run_ptin({"render", store, "--size", "1400", "1400", "-o", disk.path() + "/a.png", "-q"}), 7,
      "a.png");
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
}

}  // namespace
}  // namespace ptin::tools
