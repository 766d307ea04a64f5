// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/raster/raster_source.h"

namespace ptin {
namespace {

struct Samples {
  std::vector<HeightBits> heights;
  std::vector<std::uint8_t> valid;
  friend bool operator==(const Samples&, const Samples&) = default;
};

Samples read(const RasterSource& source, std::int64_t x, std::int64_t y, std::int64_t side) {
  const auto n = static_cast<std::size_t>(side * side);
  Samples samples{std::vector<HeightBits>(n), std::vector<std::uint8_t>(n)};
  source.read({x, y, side, side}, samples.heights, samples.valid);
  return samples;
}

TEST(RasterSourceConcurrency, GivesEveryThreadTheSameSamples) {
  const RasterSource source = RasterSource::open({PTIN_TEST_DATA "/coast_257.tif"}, {});
  std::vector<Samples> expected;
  for (std::int64_t i = 0; i < 16; ++i) {
    expected.push_back(read(source, i * 12, i * 11, 65));
  }
  std::vector<int> wrong(8, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      const RasterSource own = source.duplicate();
      for (std::int64_t i = 0; i < 64; ++i) {
        const std::int64_t at = (i + static_cast<std::int64_t>(t)) % 16;
        const RasterSource& used = t % 2 == 0 ? own : source;
        wrong[t] +=
            read(used, at * 12, at * 11, 65) == expected[static_cast<std::size_t>(at)] ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(wrong, std::vector<int>(8, 0));
}

}  // namespace
}  // namespace ptin
