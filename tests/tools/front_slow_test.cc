// SPDX-License-Identifier: GPL-3.0-or-later
//
// The front program that was built: alone, and as it becomes the whole program. Under sanitizers there is one program.
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/tools/front_answers.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

namespace fs = std::filesystem;
using testing::front_answers;
using testing::Outcome;
using testing::TestFolder;

/// The program that was built, in a folder without the whole program.
class FrontAlone : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_.file("bin"));
    fs::create_hard_link(PTIN_PROGRAM, program_);
  }

  /// Status, and all that is said.
  [[nodiscard]] Outcome run(const std::string& arguments, const std::string& variables = "") const {
    Outcome outcome;
    const std::string command = variables + " '" + program_ + "' " + arguments + " 2>&1";
    FILE* const pipe = ::popen(command.c_str(), "r");
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) outcome.out += static_cast<char>(c);
    outcome.status = WEXITSTATUS(::pclose(pipe));
    return outcome;
  }

  /// Where a file can have a second name of the program's.
  const TestFolder folder_{fs::path(PTIN_PROGRAM).parent_path()};
  const std::string program_ = folder_.file("bin/ptin");
};

TEST_F(FrontAlone, LoadsNeitherGdalNorProjNorCurl) {
  const std::string libraries = run("", "LD_TRACE_LOADED_OBJECTS=1").out;
  EXPECT_NE(libraries.find("libc.so"), std::string::npos);
  for (const char* name : {"libgdal", "libproj", "libcurl"})
    EXPECT_EQ(libraries.find(name), std::string::npos) << libraries;
}

TEST_F(FrontAlone, AnswersQuestions) {
  const std::string store = testing::built(folder_, "mountains_257.tif", "m.ptin");
  const std::string out = folder_.file("out");
  for (std::string told :
       {"--version", "build --help", "info FILE", "locate FILE 380000 3800000 --json",
        "highest FILE", "sight FILE 380000 3800000 2 381000 3801000 2",
        "volume FILE --level 1000 --error 50", "isoline FILE --level 1000 -o OUT.geojson",
        "isoline FILE --level 1000 -o -", "refine FILE --error 20 -o OUT.ply",
        "export FILE --error 20 -o OUT.obj", "stream FILE --error 50 -o OUT.ptins",
        "render FILE --error 50 --size 100 100 -o OUT.png"}) {
    if (const auto at = told.find("FILE"); at != std::string::npos) told.replace(at, 4, store);
    if (const auto at = told.find("OUT"); at != std::string::npos) told.replace(at, 3, out);
    const Outcome outcome = run(told);
    EXPECT_EQ(outcome.status, 0) << told << "\n" << outcome.out;
  }
}

TEST_F(FrontAlone, SaysWhichProgramIsMissing) {
  const Outcome outcome = run("build none.tif -o none.ptin");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_EQ(outcome.out.find("ptin: " + folder_.path().string()), 0U) << outcome.out;
  EXPECT_NE(outcome.out.find("/ptin-whole: this work needs GDAL"), std::string::npos);
  EXPECT_EQ(testing::lines_in(outcome.out), 1U);
  const Outcome told = run("build none.tif -o none.ptin --json");
  EXPECT_EQ(told.status, 3);
  EXPECT_EQ(nlohmann::json::parse(told.out)["error"]["code"], "not_found");
}

/// The library that it needs is loaded from beside the whole program, which is not there.
TEST_F(FrontAlone, RefusesTheSecondIndexAlone) {
  const std::string store = testing::built(folder_, "mountains_257.tif", "m.ptin");
  const Outcome outcome = run("locate " + store + " 380000 3800000 --index spatialindex");
  EXPECT_EQ(outcome.status, 3);
  EXPECT_NE(outcome.out.find("needs libspatialindex"), std::string::npos) << outcome.out;
}

TEST(FrontProgram, LoadsTheSecondIndex) {
  const TestFolder folder;
  const std::string store = testing::built(folder, "mountains_257.tif", "m.ptin");
  const std::vector<std::string> words = {"locate",  store,     "380000",
                                          "3800000", "--index", "spatialindex"};
  const Outcome here = testing::run_ptin(words), there = testing::spawn_ptin(words);
  EXPECT_EQ(there.status, 0) << there.err;
  EXPECT_EQ(there.out, here.out);
}

/// That a point may be meant as longitude and latitude is known by PROJ, when the answer is at hand.
TEST(FrontProgram, BecomesTheWholeProgramInTheMiddleOfItsWork) {
  const TestFolder folder;
  const std::string store = testing::built(folder, "mountains_257.tif", "m.ptin");
  const std::vector<std::string> words = {"locate", store, "-118.3", "34.35"};
  ASSERT_TRUE(front_answers(words));
  const Outcome here = testing::run_ptin(words), there = testing::spawn_ptin(words);
  EXPECT_NE(here.err.find("as longitude and latitude"), std::string::npos) << here.err;
  EXPECT_EQ(there.status, here.status);
  EXPECT_EQ(there.out, here.out);
  EXPECT_EQ(there.err, here.err);
}

}  // namespace
}  // namespace ptin::tools
