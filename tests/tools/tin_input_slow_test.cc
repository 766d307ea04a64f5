// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs that others made, as they are; and one in tiles, within a memory that a sanitizer would take for itself.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::spawn_ptin;
using testing::TestFolder;

/// The triangles of the file are those of the terrain, however many tiles they are built in.
TEST(TinInput, IsTheSameTinInAnyTiles) {
  const TestFolder folder;
  (void)testing::built(folder, "coast_257.tif", "a.ptin");
  expect_done({"export", folder.file("a.ptin"), "--error", "2", "-o", folder.file("a.ply"), "-q"});
  const auto built = [&](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> all = {"build", folder.file("a.ply"), "-o", folder.file(name), "-q"};
    all.insert(all.end(), options.begin(), options.end());
    // A limit on memory counts what a process holds: this one has kept what others freed.
    const auto outcome = spawn_ptin(all);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    expect_done({"export", folder.file(name), "-o", folder.file(name + ".ply"), "-q"});
    return read_file(folder.file(name + ".ply"));
  };
  const std::string whole = built("whole.ptin", {});
  EXPECT_TRUE(built("tiles.ptin", {"--tile", "16", "--threads", "1"}) == whole);
  EXPECT_TRUE(built("again.ptin", {"--tile", "16", "--threads", "2", "--memory", "128M"}) == whole);
  EXPECT_TRUE(read_file(folder.file("tiles.ptin")) == read_file(folder.file("again.ptin")));
  expect_done({"verify", folder.file("tiles.ptin"), "--against", folder.file("a.ply"), "-q"});
}

TEST(TinInputSlow, RealOnes) {
  const std::string data = PTIN_SHARED_DATA;
  if (!std::filesystem::exists(data + "/landxml_total_topp.xml")) {
    GTEST_SKIP() << "needs landxml_total_topp.xml in " << data;
  }
  const TestFolder folder;
  const Outcome xml = run_ptin(
      {"build", data + "/landxml_total_topp.xml", "-o", folder.file("x.ptin"), "-q", "--json"});
  ASSERT_EQ(xml.status, 0) << xml.err;
  EXPECT_EQ(json::parse(xml.out).at("left_out_triangles"), 8001);
  expect_done(
      {"verify", folder.file("x.ptin"), "--against", data + "/landxml_total_topp.xml", "-q"});
  const Outcome dirty =
      run_ptin({"build", data + "/mdal_test_mesh.ply", "-o", folder.file("m.ptin"), "-q", "--a-srs",
                "EPSG:27700"});  // it says degrees of metres
  EXPECT_EQ(dirty.status, 2);
  EXPECT_NE(dirty.err.find("9110 triangles have no area"), std::string::npos) << dirty.err;
  EXPECT_NE(dirty.err.find("532 triangles are turned over"), std::string::npos) << dirty.err;
  expect_done({"build", data + "/mdal_test_mesh.ply", "-o", folder.file("m.ptin"), "-q", "--repair",
               "--a-srs", "EPSG:27700"});
}

}  // namespace
}  // namespace ptin::tools
