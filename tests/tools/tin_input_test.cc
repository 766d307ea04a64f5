// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs through the whole program: built, exported, built again; broken ones; real ones.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::read_file;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;

void expect_done(const std::vector<std::string>& arguments) {
  const Outcome outcome = run_ptin(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

/// A surface with voids comes back from its own export, bit for bit, and verifies against it.
TEST(TinInput, ComesBackFromItsExport) {
  const TestFolder folder;
  expect_done({"build", test_data("coast_257.tif"), "-o", folder.file("a.ptin"), "-q"});
  expect_done({"export", folder.file("a.ptin"), "--error", "1", "-o", folder.file("a.ply"), "-q"});
  const Outcome built =
      run_ptin({"build", folder.file("a.ply"), "-o", folder.file("b.ptin"), "-q", "--json"});
  ASSERT_EQ(built.status, 0) << built.err;
  const json report = json::parse(built.out);
  EXPECT_GT(report.at("void_triangles"), 0);
  expect_done({"export", folder.file("b.ptin"), "-o", folder.file("b.ply"), "-q"});
  EXPECT_EQ(read_file(folder.file("b.ply")).size(), read_file(folder.file("a.ply")).size());
  expect_done({"verify", folder.file("b.ptin"), "--against", folder.file("a.ply"), "-q"});
  // Another format of the same triangles makes the same terrain.
  expect_done({"refine", folder.file("b.ptin"), "-o", folder.file("b.obj")});
  expect_done(
      {"build", folder.file("b.obj"), "-o", folder.file("c.ptin"), "-q", "--a-srs", "EPSG:4326"});
  expect_done({"export", folder.file("c.ptin"), "-o", folder.file("c.ply"), "-q"});
  EXPECT_TRUE(read_file(folder.file("c.ply")) == read_file(folder.file("b.ply")));
}

TEST(TinInput, IsRefusedWhenBrokenAndRepairedWhenAsked) {
  const TestFolder folder;
  const std::string mesh = folder.file("m.obj");
  testing::write_file(mesh, "v 0 0 0\nv 9 0 1\nv 9 9 2\nv 0 9 3\nf 1 2 3\nf 1 4 3\nf 2 3 1\n");
  const Outcome refused = run_ptin({"build", mesh, "-o", folder.file("m.ptin"), "-q"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("1 triangle is turned over"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--repair"), std::string::npos);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"m.obj"});
  expect_done({"build", mesh, "-o", folder.file("m.ptin"), "-q", "--repair"});
  expect_done({"verify", folder.file("m.ptin"), "--against", mesh, "-q"});
  const Outcome several = run_ptin({"build", mesh, mesh, "-o", folder.file("n.ptin"), "-q"});
  EXPECT_EQ(several.status, 2);
  EXPECT_NE(several.err.find("build a TIN alone"), std::string::npos) << several.err;
  EXPECT_EQ(run_ptin({"build", folder.file("no.ply"), "-o", folder.file("n.ptin")}).status, 3);
}

TEST(TinInput, RealOnes) {
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
      run_ptin({"build", data + "/mdal_test_mesh.ply", "-o", folder.file("m.ptin"), "-q"});
  EXPECT_EQ(dirty.status, 2);
  EXPECT_NE(dirty.err.find("9110 triangles have no area"), std::string::npos) << dirty.err;
  EXPECT_NE(dirty.err.find("532 triangles are turned over"), std::string::npos) << dirty.err;
  expect_done(
      {"build", data + "/mdal_test_mesh.ply", "-o", folder.file("m.ptin"), "-q", "--repair"});
}

}  // namespace
}  // namespace ptin::tools
