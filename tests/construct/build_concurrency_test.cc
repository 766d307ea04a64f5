// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds by several workers give the bytes of one worker. Small, so that a thread sanitizer can
// watch.
#include <atomic>
#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/told_build.h"

namespace ptin {
namespace {

// Under the thread sanitizer all takes twenty times as long: of half of the samples.
#ifdef __SANITIZE_THREAD__
constexpr int kSide = 57, kPoints = 1500;
#else
constexpr int kSide = 81, kPoints = 3000;
#endif

oracle::RasterFile coast() {
  oracle::RasterFile file;
  file.columns = file.rows = kSide;
  file.nodata = -1;
  file.value = [](int x, int y) {
    const double height = 100.0 * std::sin(0.1 * x) * std::cos(0.07 * y) + (x * 7 + y * 5) % 11;
    return height < -40.0 ? -1.0 : std::floor(height) + 100.0;
  };
  return file;
}

std::string scattered() {
  std::string text;
  std::uint32_t random = 1;
  const auto next = [&] { return random = random * 1664525U + 1013904223U; };
  for (int i = 0; i < kPoints; ++i) {
    const std::uint32_t x = next() >> 20, y = next() >> 20;
    text += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(x * y % 83) + "\n";
  }
  return text;
}

void expect_same_bytes_with_more_threads(const std::string& input, const BuildOptions& options) {
  const oracle::ScratchFolder folder;
  std::string expected;
  for (const int threads : {1, 2, 4}) {
    const std::string output = folder.file(std::to_string(threads) + ".ptin");
    BuildResources resources;
    resources.threads = threads;
    resources.memory_bytes = std::uint64_t{1} << 30;
    resources.checkpoint_interval = std::chrono::milliseconds(threads == 2 ? 0 : 50);
    std::uint64_t reports = 0;
    oracle::ToldBuild told;
    resources.observer = &told;
    std::atomic<bool> is_told{false};
    told.on_stage = [&](const char*, std::uint64_t, std::uint64_t) {
      EXPECT_FALSE(is_told.exchange(true)) << "told by two threads at once";
      ++reports;
      is_told = false;
    };
    build({input}, output, options, resources);
    EXPECT_GT(reports, 10U);
    const std::string bytes = oracle::bytes_of(output);
    expected = threads == 1 ? bytes : expected;
    EXPECT_TRUE(bytes == expected) << threads << " threads";
  }
}

TEST(BuildConcurrency, ARasterByManyWorkersIsThatOfOne) {
  const oracle::WrittenRaster raster(coast());
  BuildOptions options;
  options.tile = 10;
  expect_same_bytes_with_more_threads(raster.path(), options);
}

TEST(BuildConcurrency, PointsByManyWorkersAreThoseOfOne) {
  const oracle::ScratchFolder folder;
  oracle::write_text(folder.file("points.xyz"), scattered());
  BuildOptions options;
  options.tile = 12;
  options.max_edge = 200.0;
  expect_same_bytes_with_more_threads(folder.file("points.xyz"), options);
}

}  // namespace
}  // namespace ptin
