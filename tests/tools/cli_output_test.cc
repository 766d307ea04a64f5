// SPDX-License-Identifier: GPL-3.0-or-later
//
// Outputs that the system does not take, links, and signals: the documented exit status, one clear
// sentence, and nothing left behind.
#include <algorithm>
#include <csignal>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/test_folder.h"
#include "tests/tools/program.h"
#include "tests/tools/refusal.h"

namespace ptin::tools {
namespace {

using testing::expect_refusal;
using testing::make_raster;
using testing::Outcome;
using testing::RasterRecipe;
using testing::read_file;
using testing::run_ptin;
using testing::small_store;
using testing::spawn_ptin;
using testing::TestFolder;
using testing::write_file;

TEST(CliBadInput, FolderWithoutWritePermission) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  const TestFolder folder;
  const std::string store = small_store(folder);
  std::filesystem::create_directory(folder.file("locked"));
  chmod(folder.file("locked").c_str(), 0500);
  expect_refusal(run_ptin({"refine", store, "-o", folder.file("locked/a.ply")}), 6, "locked");
  expect_refusal(
      run_ptin({"build", folder.file("hills.tif"), "-o", folder.file("locked/a.ptin"), "-q"}), 6,
      "locked");
}

TEST(CliOutput, KeepsTheCapitalsOfAShapefile) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const Outcome outcome =
      run_ptin({"isoline", store, "-i", "10", "-o", folder.file("X.SHP"), "-q"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto names = folder.names();
  for (const std::string name : {"X.SHP", "X.SHX", "X.DBF"}) {
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  }
}

/// Files that are made from now on may have so many bytes; as `ulimit -f`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(CliBadInput, FilesLargerThanTheLimitOfTheProcess) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const auto before = folder.names();
  const FileSizeLimit limit(2048);
  expect_refusal(spawn_ptin({"refine", store, "-o", folder.file("a.ply")}), 7, "too large");
  expect_refusal(spawn_ptin({"stream", store, "-o", folder.file("a.pts")}), 7, "too large");
  EXPECT_EQ(
      spawn_ptin({"build", folder.file("hills.tif"), "-q", "-o", folder.file("b.ptin")}).status, 7);
  EXPECT_EQ(folder.names(), before);
}

/// The link stays, and what it names is replaced.
TEST(CliOutput, GoesWhereALinkLeads) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  std::filesystem::create_directory(folder.file("real"));
  const auto question = [&](const std::string& name) {
    const std::string out = folder.file(name);
    if (name == "a.ptin")
      return std::vector<std::string>{"build", folder.file("hills.tif"), "-o", out};
    if (name == "a.gpkg") return std::vector<std::string>{"isoline", store, "-i", "10", "-o", out};
    if (name == "a.tif") return std::vector<std::string>{"export", store, "-o", out};
    return std::vector<std::string>{"refine", store, "-o", out};
  };
  for (const std::string name : {"a.ptin", "a.gpkg", "a.tif", "a.ply"}) {
    std::filesystem::create_symlink("real/x.dat", folder.file(name));
    std::vector<std::string> arguments = question(name);
    testing::expect_done(arguments);  // to where nothing is yet
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file(name))) << name;
    const std::string written = read_file(folder.file("real/x.dat"));
    EXPECT_GT(written.size(), 100U) << name;
    write_file(folder.file("real/x.dat"), "old");
    arguments.emplace_back("--overwrite");
    testing::expect_done(arguments);
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file(name))) << name;
    EXPECT_EQ(read_file(folder.file("real/x.dat")).size(), written.size()) << name;
    std::filesystem::remove(folder.file("real/x.dat"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("real"))) << name;
  }
}

/// Standard output that is a file: what /dev/stdout leads to.
TEST(CliBadInput, OutputThatLeadsToStandardOutput) {
  const TestFolder folder;
  const std::string store = small_store(folder);
  const auto links = {folder.file("a.ply"), folder.file("a.gpkg"), folder.file("a.tif")};
  for (const std::string& link : links) {
    std::filesystem::create_symlink("/proc/self/fd/1", link);
    const Outcome outcome = link.ends_with(".gpkg")
                                ? run_ptin({"isoline", store, "-i", "9", "--overwrite", "-o", link})
                                : run_ptin({"export", store, "--overwrite", "-o", link});
    expect_refusal(outcome, 2, "leads under /dev or /proc");
    EXPECT_TRUE(std::filesystem::is_symlink(link)) << link;
  }
}

TEST(CliSignals, StopABuildTidily) {
  const TestFolder folder;
  RasterRecipe large;
  large.width = large.height = 1500;
  make_raster(folder.file("large.tif"), large);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Outcome outcome =
        spawn_ptin({"build", folder.file("large.tif"), "-o", folder.file("large.ptin"), "-q"},
                   signal, std::chrono::milliseconds(700));
    expect_refusal(outcome, 8, "");
    // What is done is kept, and goes when it is told to.
    const auto names = folder.names();
    EXPECT_EQ(std::count(names.begin(), names.end(), "large.ptin"), 0);
    const bool is_kept = names.size() == 2;
    EXPECT_EQ(spawn_ptin({"build", "--discard", "-q", "-o", folder.file("large.ptin")}).status,
              is_kept ? 0 : 1);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"large.tif"});
  }
}

}  // namespace
}  // namespace ptin::tools
