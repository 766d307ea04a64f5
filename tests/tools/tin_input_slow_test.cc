// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs that others made, as they are.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::expect_done;
using testing::Outcome;
using testing::run_ptin;
using testing::TestFolder;

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
