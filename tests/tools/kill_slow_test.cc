// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds that are killed without a word, and disks that fill up: the output's name shows nothing,
// and
// --resume gives the bytes of a build that nobody disturbed.
#include <csignal>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using testing::make_raster;
using testing::RasterRecipe;
using testing::read_file;
using testing::run_ptin;
using testing::TestFolder;

constexpr int kMoments = 20;

/// A terrain that takes a second or two.
void make_terrain(const TestFolder& folder) {
  RasterRecipe recipe;
  recipe.width = recipe.height = 400;
  recipe.value = [](int x, int y) { return testing::hills(x, y) + (x * 31 + y * 17) % 23; };
  make_raster(folder.file("dem.tif"), recipe);
}

TEST(KillSlow, AtTwentyRandomMomentsThenResumedGivesTheSameBytes) {
  const TestFolder folder;
  make_terrain(folder);
  const auto build = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(),
                {"build", folder.file("dem.tif"), "-o", folder.file(name), "--tile", "64", "-q"});
    return more;
  };
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run_ptin(build("plain.ptin", {})).status, 0);
  const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::steady_clock::now() - begin);
  const std::string expected = read_file(folder.file("plain.ptin"));

  std::mt19937 random(20);
  int killed = 0;
  for (int moment = 0; moment < kMoments; ++moment) {
    const std::chrono::milliseconds after(random() % static_cast<unsigned>(whole.count()));
    const auto outcome = run_ptin(build("k.ptin", {"--resume", "--threads", "2"}), SIGKILL, after);
    killed += outcome.status == 128 + SIGKILL ? 1 : 0;
    if (outcome.status != 0) {
      EXPECT_EQ(outcome.status, 128 + SIGKILL) << outcome.err;
      // Killed after it was complete and had its name: nothing but tidying is left.
      const bool is_complete = std::filesystem::exists(folder.file("k.ptin"));
      EXPECT_TRUE(!is_complete || read_file(folder.file("k.ptin")) == expected);
      const auto resumed = run_ptin(build("k.ptin", {"--resume", "--threads", "1"}));
      EXPECT_TRUE(resumed.status == 0 || (is_complete && resumed.status == 2)) << resumed.err;
    }
    EXPECT_TRUE(read_file(folder.file("k.ptin")) == expected) << "after " << after.count() << " ms";
    std::filesystem::remove(folder.file("k.ptin"));
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"dem.tif", "plain.ptin"}));
  }
  EXPECT_GT(killed, kMoments / 2);
}

TEST(KillSlow, ADiskThatFillsUpLosesNothing) {
  const TestFolder folder;
  make_terrain(folder);
  const std::string disk = folder.file("disk");
  std::filesystem::create_directory(disk);
  ASSERT_EQ(run_ptin({"build", folder.file("dem.tif"), "-o", folder.file("plain.ptin"), "--tile",
                      "64", "-q"})
                .status,
            0);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=40m") != 0) {
    GTEST_SKIP() << "a tmpfs cannot be mounted here";
  }
  const std::vector<std::string> build{
      "build", folder.file("dem.tif"), "-o", disk + "/k.ptin", "--tile", "64", "-q", "--resume"};
  // The disk is as large as the plan wants it; then somebody else takes all that is left.
  std::thread somebody([&] {
    while (!std::filesystem::exists(disk + "/.k.ptin.ptin-build/pages")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    testing::write_file(disk + "/other", std::string(40U << 20, 'x'));
  });
  auto outcome = run_ptin(build);
  somebody.join();
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_NE(outcome.err.find("--resume"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(disk + "/k.ptin"));
  std::filesystem::remove(disk + "/other");
  outcome = run_ptin(build);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(read_file(disk + "/k.ptin") == read_file(folder.file("plain.ptin")));
  umount(disk.c_str());
}

}  // namespace
}  // namespace ptin::tools
