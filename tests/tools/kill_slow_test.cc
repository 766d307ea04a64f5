// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds that are killed without a word, and disks that fill up: the output's name shows nothing,
// and --resume gives the bytes of a build that nobody disturbed.
#include <atomic>
#include <csignal>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/share_of_cases.h"
#include "tests/support/test_folder.h"
#include "tests/tools/program.h"

namespace ptin::tools {
namespace {

using test::SmallDisk;
using testing::make_raster;
using testing::RasterRecipe;
using testing::read_file;
using testing::spawn_ptin;
using testing::TestFolder;

const int kMoments = 20 / test::share_of_cases(4);

enum class Source { kRaster, kPoints };

class KillSlow : public ::testing::TestWithParam<Source> {
 protected:
  /// @param side    Samples along a side, of a raster.
  /// @param points  Of points.
  void make_input(int side, int points) const {
    if (GetParam() == Source::kRaster) {
      RasterRecipe recipe;
      recipe.width = recipe.height = side;
      recipe.value = [](int x, int y) { return testing::hills(x, y) + (x * 31 + y * 17) % 23; };
      make_raster(input(), recipe);
      return;
    }
    std::mt19937 random(5);
    std::string text;
    for (int i = 0; i < points; ++i) {
      const auto x = random() % 40000, y = random() % 40000;
      text += std::to_string(x) + "." + std::to_string(i % 10) + " " + std::to_string(y) + " " +
              std::to_string((x / 7 + y / 11) % 900) + "\n";
    }
    testing::write_file(input(), text);
  }

  [[nodiscard]] std::string input() const {
    return folder_.file(GetParam() == Source::kRaster ? "dem.tif" : "points.xyz");
  }
  [[nodiscard]] std::vector<std::string> build(const std::string& output,
                                               std::vector<std::string> more) const {
    more.insert(more.begin(), {"build", input(), "-o", output, "--tile", "64", "-q"});
    return more;
  }

  TestFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(OfEachKind, KillSlow, ::testing::Values(Source::kRaster, Source::kPoints),
                         [](const auto& kind) {
                           return kind.param == Source::kRaster ? "Raster" : "Points";
                         });

TEST_P(KillSlow, AtRandomMomentsThenResumedGivesTheSameBytes) {
  make_input(320, 80000);
  const auto undisturbed = spawn_ptin(build(folder_.file("plain.ptin"), {}));
  ASSERT_EQ(undisturbed.status, 0);
  const std::string expected = read_file(folder_.file("plain.ptin"));
  const std::vector<std::string> names = folder_.names();
  const std::string killed_one = folder_.file("k.ptin");

  std::mt19937 random(20);
  int killed = 0;
  // A build that was through before its moment counts for nothing.
  for (int moment = 0; moment < 20 * kMoments && killed < kMoments; ++moment) {
    const std::chrono::milliseconds after(random() %
                                          static_cast<unsigned>(undisturbed.worked.count()));
    const auto outcome =
        spawn_ptin(build(killed_one, {"--resume", "--threads", "2"}), SIGKILL, after);
    // Nor does one that was killed before it had begun: its folder holds no note yet.
    const std::string manifest = folder_.file(".k.ptin.ptin-build/manifest");
    const bool has_begun =
        std::filesystem::exists(manifest) && testing::lines_in(read_file(manifest)) > 0;
    killed += outcome.status == 128 + SIGKILL && has_begun ? 1 : 0;
    if (outcome.status != 0) {
      EXPECT_EQ(outcome.status, 128 + SIGKILL) << outcome.err;
      // Killed after it was complete and had its name: nothing but tidying is left.
      const bool is_complete = std::filesystem::exists(killed_one);
      EXPECT_TRUE(!is_complete || read_file(killed_one) == expected);
      const auto resumed = spawn_ptin(build(killed_one, {"--resume", "--threads", "1"}));
      EXPECT_TRUE(resumed.status == 0 || (is_complete && resumed.status == 2)) << resumed.err;
    }
    EXPECT_TRUE(read_file(killed_one) == expected) << "after " << after.count() << " ms";
    std::filesystem::remove(killed_one);
    EXPECT_EQ(folder_.names(), names);
  }
  EXPECT_EQ(killed, kMoments);
}

TEST_P(KillSlow, ADiskThatFillsUpLosesNothing) {
  make_input(400, 120000);  // for long enough that the disk is full before the build ends
  ASSERT_EQ(spawn_ptin(build(folder_.file("plain.ptin"), {})).status, 0);
  const SmallDisk disk(folder_.file("disk"), 40);
  if (!disk.is_mounted()) GTEST_SKIP() << SmallDisk::kNeeded;
  const std::string output = disk.path() + "/k.ptin";
  // The disk is as large as the plan wants it; then somebody else takes all that is left: while
  // points are read, or when the tiles begin.
  const std::string begun = GetParam() == Source::kRaster ? "pages" : "manifest";
  std::atomic<bool> has_ended{false};
  std::thread somebody([&] {
    while (!has_ended && !std::filesystem::exists(disk.path() + "/.k.ptin.ptin-build/" + begun)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    testing::write_file(disk.path() + "/other", std::string(40U << 20, 'x'));
  });
  auto outcome = spawn_ptin(build(output, {"--resume"}));
  has_ended = true;
  somebody.join();
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_EQ(outcome.err.find("--resume") != std::string::npos,
            std::filesystem::exists(disk.path() + "/.k.ptin.ptin-build"))
      << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(output));
  std::filesystem::remove(disk.path() + "/other");
  outcome = spawn_ptin(build(output, {"--resume"}));
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(read_file(output) == read_file(folder_.file("plain.ptin")));
}

}  // namespace
}  // namespace ptin::tools
