// SPDX-License-Identifier: GPL-3.0-or-later
//
// Commands in which the n-th allocation fails, or all from the n-th on: the status is 7 with one
// sentence, wherever it happens, and nothing of the output is left; or the output is whole. Each
// runs in a child of this process, since libraries allocate in destructors too, which ends a
// process.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <cpl_conv.h>
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/replaced_new.h"
#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"
#include "tools/ptin/cli.h"

namespace {

std::atomic<std::int64_t> allocations_done{0};
std::int64_t first_that_fails = 0;
bool all_fail_from_there = false;

/// Whether GEOS allocates. GDAL 3.6 uses what GEOS makes without asking whether it was made
/// (OGRGeometryFactory::createFromGEOS), so that the process ends there.
bool is_of_geos() {
  std::array<void*, 8> frames{};
  const int count = ::backtrace(frames.data(), static_cast<int>(frames.size()));
  return std::any_of(frames.begin(), frames.begin() + count, [](void* frame) {
    Dl_info info{};
    return ::dladdr(frame, &info) != 0 && std::strstr(info.dli_fname, "libgeos") != nullptr;
  });
}

bool fails() {
  const std::int64_t number = allocations_done.fetch_add(1, std::memory_order_relaxed) + 1;
  const bool is_chosen =
      number == first_that_fails || (all_fail_from_there && number > first_that_fails);
  return is_chosen && !is_of_geos();
}

}  // namespace

namespace ptin::tools {
namespace {

using testing::Outcome;
using testing::read_file;
using testing::TestFolder;

using Arguments = std::vector<std::string>;

class RefusedMemory : public ::testing::Test {
 protected:
  void SetUp() override {
#ifndef PTIN_TEST_ALLOCATES
    GTEST_SKIP() << "needs a program without a sanitizer, which allocates by itself";
#endif
    CPLSetConfigOption("OGR_CURRENT_DATE", "2026-01-01T00:00:00.000Z");  // else GeoPackages differ
    testing::RasterRecipe recipe;
    testing::make_raster(file("t.tif"), recipe);
    testing::expect_done({"build", file("t.tif"), "-o", store_, "-q"});
    std::filesystem::create_directory(folder_.file("out"));
  }
  void TearDown() override { CPLSetConfigOption("OGR_CURRENT_DATE", nullptr); }

  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string output(const std::string& name) const { return file("out/" + name); }
  /// Names in the folder of the output.
  [[nodiscard]] Arguments names() const {
    Arguments names;
    for (const auto& entry : std::filesystem::directory_iterator(file("out")))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  /// Runs ptin in a child; allocations fail from the n-th on, or the n-th alone; for 0 none does.
  /// Only status and err are set.
  Outcome ran(const Arguments& arguments, std::int64_t nth, bool all) {
    std::vector<const char*> argv{"ptin"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    const std::string err = file("err"), counted = file("counted");
    const pid_t child = ::fork();
    if (child == 0) {
      const int to = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      ::dup2(to, 1);
      ::dup2(to, 2);
      first_that_fails = nth;
      all_fail_from_there = all;
      Context context;
      int status = 0;
      {
        const test::AskedAllocations asked(fails);
        status = run_program(static_cast<int>(argv.size()), argv.data(), context);
      }
      const int count = ::open(counted.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const std::int64_t done = allocations_done;
      static_cast<void>(!::write(count, &done, sizeof done));
      ::_exit(status);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    Outcome outcome;
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.err = read_file(err);
    return outcome;
  }

  /// The allocations of a command that none is refused.
  void count_allocations(const Arguments& command, std::int64_t& all) {
    ASSERT_EQ(ran(command, 0, false).status, 0) << read_file(file("err"));
    std::memcpy(&all, read_file(file("counted")).data(), sizeof all);
    ASSERT_GT(all, 1000);
  }

  /// Sentences of the program; its libraries may have said something, too.
  static int sentences_in(const std::string& err) {
    int count = 0;
    for (std::size_t at = err.find("ptin: "); at != err.npos; at = err.find("ptin: ", at + 1))
      ++count;
    return count;
  }

  /// What must hold of a command that writes `name`, wherever it is refused memory: at each of its first allocations, and at
  /// thirty places of all (fifteen, where not all cases are asked for).
  void expect_whole_or_nothing(const Arguments& command, const std::string& name) {
    std::filesystem::remove(output(name));
    std::int64_t all = 0;
    ASSERT_NO_FATAL_FAILURE(count_allocations(command, all));
    const std::string whole = read_file(output(name));
    constexpr std::int64_t kOneByOne = 8;
    const std::int64_t stride = all / (30 / test::share_of_cases(2)) + 1;
    for (const bool from_there_on : {false, true}) {
      for (std::int64_t n = 1; n <= all && !HasFailure(); n += n < kOneByOne ? 1 : stride) {
        SCOPED_TRACE(command[0] + " " + name + ": allocation " + std::to_string(n) + " of " +
                     std::to_string(all) + (from_there_on ? " and all behind it" : ""));
        std::filesystem::remove(output(name));
        const Outcome outcome = ran(command, n, from_there_on);
        if (outcome.status == 0) {
          EXPECT_EQ(names(), Arguments{name});
          EXPECT_TRUE(read_file(output(name)) == whole);
          continue;
        }
        EXPECT_EQ(outcome.status, 7) << outcome.err;
        EXPECT_NE(outcome.err.find("memory"), std::string::npos) << outcome.err;
        EXPECT_EQ(sentences_in(outcome.err), 1) << outcome.err;
        EXPECT_EQ(names(), Arguments{}) << outcome.err;
      }
    }
  }

  TestFolder folder_;
  std::string store_ = folder_.file("t.ptin");
};

TEST_F(RefusedMemory, OfLayersIsStatus7) {
  for (const std::string name : {"a.gpkg", "a.fgb", "a.geojson"}) {
    expect_whole_or_nothing({"isoline", store_, "-i", "20", "-o", output(name), "-q"}, name);
    expect_whole_or_nothing(
        {"viewshed", store_, "500500", "3999500", "2", "--radius", "300", "-o", output(name), "-q"},
        name);
  }
  for (const std::string name : {"a.dxf", "a.xml"}) {
    expect_whole_or_nothing({"isoline", store_, "-i", "20", "-o", output(name), "-q"}, name);
  }
}

TEST_F(RefusedMemory, OfSlopesIsStatus7) {
  expect_whole_or_nothing(
      {"export", store_, "-o", output("a.tif"), "-q", "--error", "5", "--what", "slope"}, "a.tif");
}

TEST_F(RefusedMemory, OfExportsIsStatus7) {
  for (const std::string name : {"a.gpkg", "a.fgb", "a.ply", "a.xml", "a.dxf", "a.stl", "a.tif"}) {
    expect_whole_or_nothing({"export", store_, "-o", output(name), "-q", "--error", "5"}, name);
  }
}

TEST_F(RefusedMemory, OfProfilesAndMeshesIsStatus7) {
  expect_whole_or_nothing({"profile", store_, "--line",
                           "LINESTRING(500100 3999900, 500700 3999300)", "-o", output("a.geojson")},
                          "a.geojson");
  for (const std::string name : {"a.png", "a.svg"}) {
    expect_whole_or_nothing({"profile", store_, "--line",
                             "LINESTRING(500100 3999900, 500700 3999300)", "-o", output(name)},
                            name);
  }
  expect_whole_or_nothing({"refine", store_, "-o", output("a.glb"), "-q"}, "a.glb");
}

TEST_F(RefusedMemory, IsToldAsJson) {
  const Outcome outcome = ran({"info", store_, "--json"}, 40, true);
  EXPECT_EQ(outcome.status, 7);
  const auto told = nlohmann::json::parse(outcome.err, nullptr, false);
  ASSERT_TRUE(told.is_object()) << outcome.err;
  EXPECT_EQ(told["error"]["code"], "resource_exhausted");
}

/// A build's work stays for --resume, so only the output and the status are looked at. The source
/// is text without a CRS: GDAL calls a raster none that it reads where it is refused memory, and
/// PROJ 9.1 ends the process (proj_create_geographic_crs() of a datum that could not be made).
TEST_F(RefusedMemory, OfBuildsIsStatus7) {
  std::string points;
  for (int i = 0; i < 400; ++i) {
    points += std::to_string(i % 20 * 10) + " " + std::to_string(i / 20 * 10) + " " +
              std::to_string(testing::hills(i % 20, i / 20)) + "\n";
  }
  testing::write_file(file("points.xyz"), points);
  const Arguments command = {"build", file("points.xyz"), "-o", output("b.ptin"),
                             "-q",    "--threads",        "1"};
  std::int64_t all = 0;
  ASSERT_NO_FATAL_FAILURE(count_allocations(command, all));
  const std::string whole = read_file(output("b.ptin"));
  std::filesystem::remove(output("b.ptin"));
  for (const bool from_there_on : {false, true}) {
    for (std::int64_t n = 1; n <= all && !HasFailure(); n += n < 20 ? 1 : 149) {
      SCOPED_TRACE("allocation " + std::to_string(n) + " of " + std::to_string(all) +
                   (from_there_on ? " and all behind it" : ""));
      const Outcome outcome = ran(command, n, from_there_on);
      // What was refused may be done without, as the buffer of a stable sort; or it came behind the
      // output, as what the destructors of JSON allocate.
      if (outcome.status != 0) {
        EXPECT_EQ(outcome.status, 7) << outcome.err;
      }
      if (std::filesystem::exists(output("b.ptin"))) {
        EXPECT_TRUE(read_file(output("b.ptin")) == whole);
      } else {
        EXPECT_EQ(outcome.status, 7) << outcome.err;
      }
      const bool says_kept = outcome.err.find("--resume") != std::string::npos;
      EXPECT_TRUE(!says_kept || !names().empty()) << outcome.err;
      std::filesystem::remove_all(file("out"));
      std::filesystem::create_directory(file("out"));
    }
  }
}

}  // namespace
}  // namespace ptin::tools
