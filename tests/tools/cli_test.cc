// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program end to end, on small real terrains.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/mesh_reader.h"
#include "tests/tools/program.h"
#include "tools/ptin/command.h"

namespace ptin::tools {
namespace {

using nlohmann::json;
using testing::answer_of;
using testing::built;
using testing::expect_done;
using testing::Outcome;
using testing::read_file;
using testing::ReadMesh;
using testing::run_ptin;
using testing::test_data;
using testing::TestFolder;
using testing::write_file;

TEST(Cli, HelpAndVersionAreNoErrors) {
  EXPECT_EQ(run_ptin({"--help"}).status, 0);
  EXPECT_TRUE(run_ptin({"--version"}).out.starts_with("ptin "));
  for (const char* command :
       {"build", "info", "verify", "refine", "isoline", "locate", "profile", "sight", "stream",
        "unstream", "viewer", "tiles", "highest", "volume", "render", "bench", "completion"}) {
    const Outcome help = run_ptin({command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_NE(help.out.find("Example"), std::string::npos)
        << command << " --help ends with examples";
  }
}

TEST(Cli, EverySubcommandTakesTheCommonOptions) {
  for (const Command& command : commands()) {
    const std::string help = run_ptin({command.name, "--help"}).out;
    EXPECT_NE(help.find("-q,--quiet"), std::string::npos) << command.name;
    EXPECT_NE(help.find("--json"), std::string::npos) << command.name;
  }
}

TEST(Cli, ABuildNamesFilesWithoutAPoint) {
  const TestFolder folder;
  const std::string points = folder.file("points.xyz"), empty = folder.file("empty.xyz"),
                    header = folder.file("header.xyz"), out = folder.file("a.ptin");
  write_file(points, "x y z\n0 0 1\n5 0 2\n0 5 3\n");
  write_file(empty, "");
  write_file(header, "x y z\n");
  const Outcome one = run_ptin({"build", points, empty, "-o", out});
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_NE(one.err.find("there is no point in " + empty + ";"), std::string::npos) << one.err;
  const Outcome two = run_ptin({"build", empty, points, header, "-o", out, "--overwrite"});
  EXPECT_NE(two.err.find(empty + ", nor in 1 other file;"), std::string::npos) << two.err;
  const json told = answer_of({"build", empty, points, header, "-o", out, "--overwrite", "--json"});
  EXPECT_EQ(told.at("empty_inputs"), json({empty, header}));
  EXPECT_EQ(run_ptin({"build", points, "-o", out, "--overwrite"}).err.find("no point"),
            std::string::npos);
}

TEST(Cli, QuestionsAreAnsweredQuietlyToo) {
  const TestFolder folder;
  const std::string coarse = folder.file("coarse.ptin");
  expect_done({"build", test_data("mountains_257.tif"), "-o", coarse, "-q", "--max-error", "20"});
  const json b = answer_of({"info", coarse, "--json", "-q"}).at("bounds");
  const std::string x = b.at("min_x").dump(), y = b.at("min_y").dump();
  const std::string line = "MULTILINESTRING((" + x + " " + y + "," + b.at("max_x").dump() + " " +
                           b.at("max_y").dump() + "),(" + x + " " + y + "," + x + " " + y + "))";
  const std::vector<std::vector<std::string>> questions = {
      {"info", coarse},
      {"locate", coarse, x, y, "--error", "1"},
      {"profile", coarse, "--line", line, "--error", "1"},
      {"highest", coarse, "--error", "1"},
      {"volume", coarse, "--level", "900", "--error", "1"},
      {"sight", coarse, x, y, "2", b.at("max_x").dump(), y, "2", "--error", "1"}};
  for (std::vector<std::string> question : questions) {
    const Outcome told = run_ptin(question);
    question.emplace_back("-q");
    const Outcome quiet = run_ptin(question);
    EXPECT_EQ(quiet.status, 0) << question[0];
    EXPECT_EQ(quiet.out, told.out) << question[0];
    EXPECT_EQ(quiet.err, "") << question[0];
    EXPECT_EQ(told.err.empty(), question[0] == "info") << question[0];
  }
}

TEST(Cli, CompletionKnowsEverySubcommandAndOption) {
  const Outcome outcome = run_ptin({"completion", "bash"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* word :
       {"build", "verify", "--max-error", "--against", "--polygon", "--wireframe"}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  }
}

TEST(Cli, ManualPageKnowsEverySubcommandAndOption) {
  const Outcome outcome = run_ptin({"completion", "man"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.out.starts_with(".TH PTIN 1"));
  for (const char* word : {"PTIN EXPORT", "\\-\\-max\\-error", "\\-\\-pixel\\-size", "EXIT STATUS",
                           "ptin build dem.tif"}) {
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  }
}

TEST(Cli, BuildReportsWhatItMade) {
  const TestFolder folder;
  const json report = answer_of(
      {"build", test_data("mountains_257.tif"), "-o", folder.file("m.ptin"), "--json", "-q"});
  EXPECT_EQ(report.at("samples"), 257 * 257);
  EXPECT_EQ(report.at("vertices"), 257 * 257);
  EXPECT_EQ(report.at("t0_vertices").get<int>() + report.at("records").get<int>(), 257 * 257);
  EXPECT_EQ(report.at("bytes"), std::filesystem::file_size(folder.file("m.ptin")));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"m.ptin"});
}

TEST(Cli, BuildSaysWhatToDoNext) {
  const TestFolder folder;
  const Outcome outcome =
      run_ptin({"build", test_data("ground_points.csv"), "-o", folder.file("g.ptin")});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.out.find("next: ptin info"), std::string::npos);
  EXPECT_NE(outcome.err.find("100 - done."), std::string::npos);
}

TEST(Cli, BuildSaysHowFlatPartsWouldTakeLess) {
  const TestFolder folder;
  testing::RasterRecipe coast;  // three quarters are sea
  coast.width = coast.height = 65;
  coast.type = "Int16";
  coast.value = [](int x, int y) { return x < 48 ? 0.0 : std::floor(10 * testing::hills(x, y)); };
  testing::make_raster(folder.file("coast.tif"), coast);
  const std::string store = folder.file("c.ptin");
  const Outcome told = run_ptin({"build", folder.file("coast.tif"), "-o", store});
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_NE(told.out.find("times the source's"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("built with --max-error 0.0"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("no sample differs"), std::string::npos) << told.out;
  const json report =
      answer_of({"build", folder.file("coast.tif"), "-o", store, "--overwrite", "--json", "-q"});
  EXPECT_EQ(report["source_bytes"], std::filesystem::file_size(folder.file("coast.tif")));
  EXPECT_GT(report["flat"]["records"], report["records"].get<int>() / 2);
  EXPECT_LT(report["flat"]["bytes"], report["bytes"]);
  const std::string small = folder.file("s.ptin");
  const double max_error = report["flat"]["max_error"];
  EXPECT_LE(max_error, 0.001);
  const json lean = answer_of({"build", folder.file("coast.tif"), "-o", small, "--json", "-q",
                               "--max-error", report["flat"]["max_error"].dump()});
  EXPECT_LE(lean["records"].get<int>(),
            report["records"].get<int>() - report["flat"]["records"].get<int>() + 200);
  EXPECT_EQ(lean["flat"]["records"], 0);
  EXPECT_EQ(lean["flat"]["max_error"], nullptr);
  const json verified = answer_of(
      {"verify", small, "--against", folder.file("coast.tif"), "--json", "-q", "--tolerance", "0"});
  for (const json& check : verified["against"]["checks"])
    EXPECT_LE(check["worst_error"], max_error);
  const Outcome again = run_ptin(
      {"build", folder.file("coast.tif"), "-o", small, "--overwrite", "--max-error", "0.0001"});
  EXPECT_EQ(again.out.find("--max-error"), std::string::npos) << again.out;
}

TEST(Cli, BuildIsDeterministic) {
  const TestFolder folder;
  for (const char* name : {"a.ptin", "b.ptin"}) {
    ASSERT_EQ(run_ptin({"build", test_data("coast_257.tif"), "-o", folder.file(name), "-q"}).status,
              0);
  }
  EXPECT_EQ(read_file(folder.file("a.ptin")), read_file(folder.file("b.ptin")));
}

TEST(Cli, BuildWithMaxErrorIsSmallerAndSaysSo) {
  const TestFolder folder;
  const std::string file = folder.file("m.ptin");
  ASSERT_EQ(
      run_ptin({"build", test_data("mountains_257.tif"), "-o", file, "--max-error", "10", "-q"})
          .status,
      0);
  const json info = answer_of({"info", file, "--json"});
  EXPECT_GT(info.at("base_error"), 0.0);
  EXPECT_LE(info.at("base_error"), 10.0);
  EXPECT_LT(info.at("vertices"), 257 * 257 / 8);
  EXPECT_EQ(run_ptin({"verify", file, "--against", test_data("mountains_257.tif"), "-q"}).status,
            0);
}

TEST(Cli, InfoHasTheDocumentedNames) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  const json info = answer_of({"info", file, "--json"});
  EXPECT_EQ(info.at("crs").at("code"), "EPSG:4326");
  EXPECT_EQ(info.at("crs").at("vertical_known"), false);
  EXPECT_EQ(info.at("units").at("horizontal"), "degree");
  EXPECT_EQ(info.at("t0_vertices").get<std::uint64_t>() + info.at("records").get<std::uint64_t>(),
            info.at("vertices"));
  std::uint64_t bytes = 0;
  for (const json& section : info.at("sections")) {
    EXPECT_TRUE(section.at("name").is_string());
    bytes = std::max(bytes, section.at("offset").get<std::uint64_t>() +
                                section.at("bytes").get<std::uint64_t>());
  }
  EXPECT_EQ(bytes, info.at("bytes"));
  for (const char* name :
       {"bounds", "heights", "rank", "base_error", "base_deviation", "error_quantiles",
        "vertices_at_tolerance", "tree", "metadata", "source_samples"}) {
    EXPECT_TRUE(info.contains(name)) << name;
  }
  const Outcome text = run_ptin({"info", file});
  EXPECT_NE(text.out.find("vertical   unknown"), std::string::npos);
}

TEST(Cli, InfoNamesTheVerticalCrs) {
  const TestFolder folder;
  const std::string file = folder.file("m.ptin");
  ASSERT_EQ(run_ptin({"build", test_data("mountains_257.tif"), "-o", file, "--vertical-crs",
                      "EPSG:5773", "-q"})
                .status,
            0);
  const json info = answer_of({"info", file, "--json"});
  EXPECT_EQ(info.at("crs").at("code"), "EPSG:32611");
  EXPECT_EQ(info.at("crs").at("vertical_code"), "EPSG:5773");
  EXPECT_EQ(info.at("units").at("height"), "metre");
}

/// Bounds of the mountains, from their info.
std::array<double, 4> bounds_of(const std::string& file) {
  const json b = answer_of({"info", file, "--json"}).at("bounds");
  return {b.at("min_x"), b.at("min_y"), b.at("max_x"), b.at("max_y")};
}

std::vector<std::string> window_arguments(const std::array<double, 4>& b, double low, double high) {
  std::vector<std::string> words{"--window"};
  for (std::size_t i = 0; i < 4; ++i) {
    const double share = i < 2 ? low : high;
    words.push_back(std::to_string(b[i % 2] + (b[i % 2 + 2] - b[i % 2]) * share));
  }
  return words;
}

ReadMesh read_mesh(const std::string& path) {
  const std::string content = read_file(path);
  if (path.ends_with(".ply")) return testing::read_ply(content);
  if (path.ends_with(".obj")) return testing::read_obj(content);
  return path.ends_with(".2dm") ? testing::read_2dm(content) : testing::read_glb(content);
}

double plan_area(const ReadMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
  }
  return area;
}

TEST(Cli, RefineWritesTheSameMeshInEveryFormat) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  for (const char* name : {"a.ply", "a.obj", "a.2dm", "a.glb"}) {
    const Outcome outcome =
        run_ptin({"refine", file, "--vertices", "2000", "-o", folder.file(name), "--stats"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("records retrieved"), std::string::npos);
    const ReadMesh mesh = read_mesh(folder.file(name));
    EXPECT_EQ(mesh.vertices.size(), 2000U) << name;
    EXPECT_GT(mesh.triangles.size(), 3000U) << name;
  }
  const ReadMesh ply = read_mesh(folder.file("a.ply"));
  EXPECT_EQ(ply.vertices, read_mesh(folder.file("a.obj")).vertices);
  EXPECT_EQ(ply.vertices, read_mesh(folder.file("a.2dm")).vertices);
  EXPECT_EQ(ply.triangles, read_mesh(folder.file("a.glb")).triangles);
  EXPECT_NEAR(plan_area(ply), 7680.0 * 7680.0, 1e-3);
  EXPECT_NE(std::find(ply.header.begin(), ply.header.end(), "comment crs: EPSG:32611"),
            ply.header.end());
}

TEST(Cli, RefineLeavesVoidsOut) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  const json answer =
      answer_of({"refine", file, "--error", "5", "-o", folder.file("a.ply"), "--json"});
  EXPECT_GT(answer.at("triangles"), answer.at("written").at("triangles"));
  EXPECT_LE(answer.at("certified_error"), 5.0);
  for (const char* name :
       {"records_retrieved", "records_applied", "index_nodes", "pages", "bytes_read", "seconds"}) {
    EXPECT_TRUE(answer.at("cost").contains(name)) << name;
  }
}

TEST(Cli, ClipKeepsWholeTrianglesAndCutCutsThem) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const auto bounds = bounds_of(file);
  std::vector<std::string> arguments{"refine", file, "--error",
                                     "5",      "-o", folder.file("whole.ply")};
  const auto window = window_arguments(bounds, 0.31, 0.62);
  arguments.insert(arguments.end(), window.begin(), window.end());
  ASSERT_EQ(run_ptin(arguments).status, 0);
  arguments.push_back("--clip");
  arguments[5] = folder.file("clip.ply");
  ASSERT_EQ(run_ptin(arguments).status, 0);
  arguments.back() = "--cut";
  arguments[5] = folder.file("cut.ply");
  ASSERT_EQ(run_ptin(arguments).status, 0);
  const double side = 7680.0 * 0.31;
  const double cut = plan_area(read_mesh(folder.file("cut.ply")));
  const double clip = plan_area(read_mesh(folder.file("clip.ply")));
  EXPECT_NEAR(cut, side * side, 1.0);
  EXPECT_GT(clip, cut);
  EXPECT_LT(clip, 2 * cut);
  EXPECT_NEAR(plan_area(read_mesh(folder.file("whole.ply"))), 7680.0 * 7680.0, 1e-3);
}

TEST(Cli, RefineTakesPolygonsAsWktAndFromFiles) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const auto b = bounds_of(file);
  char wkt[200];
  std::snprintf(wkt, sizeof wkt, "POLYGON((%f %f, %f %f, %f %f, %f %f))", b[0] + 1000, b[1] + 1000,
                b[0] + 3000, b[1] + 1000, b[0] + 3000, b[1] + 3000, b[0] + 1000, b[1] + 1000);
  testing::write_file(folder.file("p.wkt"), wkt);
  testing::write_file(folder.file("p.csv"), std::string("id,WKT\n1,\"") + wkt + "\"\n");
  for (const std::string& polygon :
       {std::string(wkt), folder.file("p.wkt"), folder.file("p.csv")}) {
    const Outcome outcome = run_ptin(
        {"refine", file, "--polygon", polygon, "--cut", "-o", folder.file("a.ply"), "--overwrite"});
    ASSERT_EQ(outcome.status, 0) << polygon << outcome.err;
    EXPECT_NEAR(plan_area(read_mesh(folder.file("a.ply"))), 2e6, 1.0) << polygon;
  }
}

TEST(Cli, RefineAtAPointGivesItsTriangle) {
  const TestFolder folder;
  const std::string file = built(folder, "mountains_257.tif");
  const auto b = bounds_of(file);
  const json answer =
      answer_of({"refine", file, "--point", std::to_string(b[0] + 1234.5),
                 std::to_string(b[1] + 2347.8), "--clip", "-o", folder.file("a.obj"), "--json"});
  EXPECT_EQ(answer.at("written").at("triangles"), 1);
  EXPECT_EQ(answer.at("exact"), true);
}

TEST(Cli, RefineAnswersTheSameByEveryIndexAndReader) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  const auto window = window_arguments(bounds_of(file), 0.2, 0.5);
  std::vector<std::string> contents;
  for (const std::vector<std::string>& extra : {std::vector<std::string>{},
                                                {"--no-mmap"},
                                                {"--index", "spatialindex"},
                                                {"--index", "packed", "--no-mmap"}}) {
    std::vector<std::string> arguments{
        "refine", file, "--error", "2", "-o", folder.file("a.ply"), "--overwrite"};
    arguments.insert(arguments.end(), window.begin(), window.end());
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const Outcome outcome = run_ptin(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    contents.push_back(read_file(folder.file("a.ply")));
    EXPECT_EQ(contents.back(), contents.front());
  }
}

TEST(Cli, RenderDrawsEveryKindOfPicture) {
  const TestFolder folder;
  const std::string file = built(folder, "coast_257.tif");
  EXPECT_EQ(run_ptin({"render", file, "-o", folder.file("a.png")}).status, 0);
  EXPECT_EQ(run_ptin({"render", file, "--error", "10", "--wireframe", "--size", "300", "200", "-o",
                      folder.file("b.png")})
                .status,
            0);
  const json answer = answer_of(
      {"render", file, "--pages", "--size", "200", "200", "-o", folder.file("c.png"), "--json"});
  EXPECT_EQ(answer.at("width"), 200);
  for (const char* name : {"a.png", "b.png", "c.png"}) {
    const std::string content = read_file(folder.file(name));
    EXPECT_EQ(content.substr(1, 3), "PNG");
    EXPECT_GT(content.size(), 5000U) << name << " shows something";
  }
}

}  // namespace
}  // namespace ptin::tools
