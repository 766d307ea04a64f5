// SPDX-License-Identifier: GPL-3.0-or-later
//
// TINs through the whole program: built, exported, built again; broken ones; real ones.
#include <array>
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
using testing::test_data;
using testing::TestFolder;

/// A surface with voids comes back from its own export, bit for bit, and verifies against it.
TEST(TinInput, ComesBackFromItsExport) {
  const TestFolder folder;
  (void)testing::built(folder, "coast_257.tif", "a.ptin");
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
  EXPECT_NE(refused.err.find("3 edges have two triangles"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--repair"), std::string::npos);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"m.obj"});
  expect_done({"build", mesh, "-o", folder.file("m.ptin"), "-q", "--repair"});
  expect_done({"verify", folder.file("m.ptin"), "--against", mesh, "-q"});
  const Outcome several = run_ptin({"build", mesh, mesh, "-o", folder.file("n.ptin"), "-q"});
  EXPECT_EQ(several.status, 2);
  EXPECT_NE(several.err.find("build a TIN alone"), std::string::npos) << several.err;
  EXPECT_EQ(run_ptin({"build", folder.file("no.ply"), "-o", folder.file("n.ptin")}).status, 3);
}

/// Two strips far apart, one triangle turned over: repaired, the gap is surface unless edges are
/// too long for it.
TEST(TinInput, IsRepairedWithVoidsWhereEdgesAreLong) {
  const TestFolder folder;
  testing::write_file(folder.file("m.2dm"),
                      "MESH2D\nND 7 0 0 0\nND 2 4 0 1\nND 3 4 4 2\nND 4 0 4 3\nND 10 100 0 1\n"
                      "ND 11 104 0 1\nND 12 104 4 2\nND 13 100 4 1\nE3T 1 7 2 3 1\nE3T 2 7 4 3 1\n"
                      "E3T 3 10 11 12 1\nE3T 4 10 12 13 1\n");
  const auto state_between = [&](const std::vector<std::string>& options) -> std::string {
    std::vector<std::string> all = {"build", folder.file("m.2dm"), "-o",      folder.file("m.ptin"),
                                    "-q",    "--overwrite",        "--repair"};
    all.insert(all.end(), options.begin(), options.end());
    expect_done(all);
    const Outcome located = run_ptin({"locate", folder.file("m.ptin"), "50", "2", "--json"});
    return json::parse(located.out).at("points").at(0).at("state");
  };
  EXPECT_EQ(state_between({}), "surface");
  EXPECT_EQ(state_between({"--max-edge", "20"}), "void");
}

/// Two surfaces of two triangles each, A from 1 to 4, B from 5 to 9.
std::string landxml_of_two_surfaces() {
  const auto surface = [](const std::string& name, const std::array<int, 4>& heights) {
    const auto point = [&](int id, const char* place) {
      return "<P id=\"" + std::to_string(id) + "\">" + place + " " +
             std::to_string(heights.at(static_cast<std::size_t>(id) - 1)) + "</P>";
    };
    return "<Surface name=\"" + name + "\"><Definition surfType=\"TIN\"><Pnts>" + point(1, "0 0") +
           point(2, "0 10") + point(3, "10 0") + point(4, "10 10") +
           "</Pnts><Faces><F>1 2 4</F><F>1 4 3</F></Faces></Definition></Surface>";
  };
  return "<?xml version=\"1.0\"?>\n"
         "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\"><Surfaces>" +
         surface("A", {1, 2, 3, 4}) + surface("B", {5, 6, 7, 9}) + "</Surfaces></LandXML>\n";
}

TEST(TinInput, TakesTheSurfaceOfLandXmlThatIsNamed) {
  const TestFolder folder;
  testing::write_file(folder.file("two.xml"), landxml_of_two_surfaces());
  testing::write_file(folder.file("one.obj"), "v 0 0 0\nv 9 0 1\nv 9 9 2\nf 1 2 3\n");
  const auto refusal = [&](const char* input, const std::vector<std::string>& options) {
    std::vector<std::string> all = {"build", folder.file(input), "-o", folder.file("no.ptin"),
                                    "-q"};
    all.insert(all.end(), options.begin(), options.end());
    const Outcome outcome = run_ptin(all);
    EXPECT_EQ(outcome.status, 2) << input << outcome.err;
    return outcome.err;
  };
  expect_done({"build", folder.file("two.xml"), "--layer", "B", "-o", folder.file("b.ptin"), "-q"});
  const json heights = testing::answer_of({"info", folder.file("b.ptin"), "--json"}).at("heights");
  EXPECT_EQ(heights.at("min"), 5.0);
  EXPECT_EQ(heights.at("max"), 9.0);
  EXPECT_NE(refusal("two.xml", {}).find("--layer"), std::string::npos);
  EXPECT_NE(refusal("two.xml", {"--layer", "C"}).find("'C'"), std::string::npos);
  EXPECT_NE(refusal("one.obj", {"--layer", "B"}).find("--layer"), std::string::npos);
  EXPECT_NE(refusal("two.xml", {"--layer", "B", "--z-field", "z"}).find("--z-field"),
            std::string::npos);
}

TEST(TinInput, IsRefusedForWhatItNames) {
  const TestFolder folder;
  const auto refusal = [&](const std::string& mesh, const std::vector<std::string>& options) {
    testing::write_file(folder.file("m.2dm"), mesh);
    std::vector<std::string> all = {"build", folder.file("m.2dm"), "-o", folder.file("m.ptin"),
                                    "-q"};
    all.insert(all.end(), options.begin(), options.end());
    const Outcome outcome = run_ptin(all);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(folder.names(), std::vector<std::string>{"m.2dm"});
    return outcome.err;
  };
  const auto says = [](const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  };
  const std::string square = "MESH2D\nND 1 0 0 0\nND 2 4 0 1\nND 3 4 4 2\nND 4 0 4 3\n";
  const std::string missing = refusal(square + "E3T 1 1 2 3 1\nE3T 2 1 3 9 1\n", {});
  EXPECT_TRUE(says(missing, "triangle 1 names vertex 9, which is not there")) << missing;
  const std::string twice = refusal(square + "ND 4 1 1 1\nE3T 1 1 2 3 1\n", {});
  EXPECT_TRUE(says(twice, "two vertices have the id 4")) << twice;
  const std::string box = refusal(square + "E3T 1 1 2 3 1\n", {"--bbox", "0", "0", "1", "1"});
  EXPECT_TRUE(says(box, "not cut by --bbox")) << box;
  const std::string over =
      refusal(square + "ND 5 9 9 0\nE3T 1 1 2 3 1\nE3T 2 1 3 4 1\nE3T 3 1 5 4 1\n", {});
  EXPECT_TRUE(says(over, "1 edge has two triangles on one side (it is at 0 0)")) << over;
}

}  // namespace
}  // namespace ptin::tools
