// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels from the heights of a raster in the file against those from stars.
#include "engine/query/raster/floor_pixels.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/build.h"
#include "engine/error.h"
#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/query/line_oracle.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

using reference::same_number;

/// A raster of whole numbers, of hundredths, or of any floats, with voids of any size in it.
std::string random_raster(const test::TestFolder& folder, std::mt19937_64& random) {
  GDALAllRegister();
  const auto below = [&](std::uint64_t n) { return static_cast<int>(random() % n); };
  const int width = 2 + below(70), height = 2 + below(70), kind = below(3);
  const double share_void = std::vector<double>{0, 0.02, 0.4, 0.95}[random() % 4];
  std::string path = folder.file("r.tif");
  const GDALDatasetUniquePtr data(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      path.c_str(), width, height, 1, kind == 0 ? GDT_Int16 : GDT_Float32, nullptr));
  std::array<double, 6> place = {1000.0 + below(50) * 0.37, 10, 0, 5000, 0, -5};
  data->SetGeoTransform(place.data());
  GDALRasterBand& band = *data->GetRasterBand(1);
  band.SetNoDataValue(-999);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<float> row(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    for (float& v : row) {
      const double any = std::floor(300 * share(random));
      v = static_cast<float>(kind == 0 ? any : kind == 1 ? 0.01 * any : 300 * share(random));
      if (share(random) < share_void && y > height / 4) v = -999;
    }
    EXPECT_EQ(
        band.RasterIO(GF_Write, 0, y, width, 1, row.data(), width, 1, GDT_Float32, 0, 0, nullptr),
        CE_None);
  }
  return path;
}

struct FloorAnswer {
  std::vector<double> heights;
  std::vector<PointState> states;
};

FloorAnswer floor_filled(const Terrain& terrain, const RasterRequest& request) {
  const auto count = static_cast<std::size_t>(request.pixels.pixels());
  FloorAnswer pixels{std::vector<double>(count, -1), std::vector<PointState>(count)};
  terrain.raster(request, pixels.heights, pixels.states);
  return pixels;
}

FloorAnswer floor_gathered(const Terrain& terrain, RasterRequest request) {
  const auto count = static_cast<std::size_t>(request.pixels.pixels());
  FloorAnswer pixels{std::vector<double>(count, -1), std::vector<PointState>(count)};
  request.states = true;
  terrain.raster(request, [&](const RasterBlock& block) {
    for (std::int64_t y = 0; y < block.pixels.height; ++y) {
      for (std::int64_t x = 0; x < block.pixels.width; ++x) {
        const auto from = static_cast<std::size_t>(y) * block.stride + static_cast<std::size_t>(x);
        const auto to = static_cast<std::size_t>((block.pixels.row - request.pixels.row + y) *
                                                     request.pixels.width +
                                                 block.pixels.column - request.pixels.column + x);
        pixels.heights[to] = block.heights[from];
        pixels.states[to] = block.states[from];
      }
    }
  });
  return pixels;
}

void require_same_answer(const FloorAnswer& a, const FloorAnswer& b) {
  RC_ASSERT(a.states == b.states);
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    RC_ASSERT(same_number(a.heights[i], b.heights[i]));
  }
}

/// Whole steps of the grid, or others, from a sample or from between them; some with a margin.
RasterRequest random_floor_request(std::mt19937_64& random, const StoreFacts& facts) {
  const auto below = [&](std::uint64_t n) { return static_cast<std::int64_t>(random() % n); };
  const auto step = [&] {
    const double steps = std::vector<double>{1, 1, 1, 2, 3, 16, 33, 0.5, 1.5}[random() % 9];
    return random() % 2 == 0 ? steps : -steps;
  };
  RasterRequest request;
  const double off = random() % 8 == 0 ? 0.5 : 0.0;
  request.lattice.origin =
      facts.map.to_map(static_cast<double>(below(90)) + off, static_cast<double>(below(90)));
  request.lattice.step_x = facts.map.step_x * step();
  request.lattice.step_y = facts.map.step_y * step();
  if (random() % 3 == 0) {
    const double margin = random() % 2 == 0 ? 0.5 : 2.5;
    request.lattice.margin = {facts.map.step_x * margin, facts.map.step_y * margin};
  }
  request.pixels = {below(40) - 30, below(40) - 30, 1 + below(130), 1 + below(130)};
  return request;
}

RC_GTEST_PROP(FloorPixels, AreThoseOfStars, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const test::TestFolder folder(test::TestFolder::Size::kSmall);
  const std::string path = folder.file("r.ptin");
  build({random_raster(folder, random)}, path, {}, {});
  const Terrain terrain = Terrain::open(path);
  RC_ASSERT(terrain.floor() != nullptr);
  Terrain by_stars = terrain;
  by_stars.use_floor(false);
  for (int i = 0; i < 8; ++i) {
    RasterRequest request = random_floor_request(random, terrain.store().facts());
    const FloorAnswer expected = floor_filled(by_stars, request);
    require_same_answer(floor_filled(terrain, request), expected);
    request.block_width = 1 + static_cast<std::int64_t>(random() % 70);
    request.block_height = 1 + static_cast<std::int64_t>(random() % 70);
    if (random() % 2 == 0) request.limits.memory_bytes = 200'000;
    require_same_answer(floor_gathered(terrain, request), expected);
  }
}

TEST(FloorPixels, StopWhenAskedTo) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  RasterRequest request;
  request.lattice = {facts.map.to_map(0, 256), facts.map.step_x, -facts.map.step_y};
  request.pixels = {0, 0, 257, 257};
  std::stop_source stop;
  request.limits.stop = stop.get_token();
  request.progress = [&](double) { stop.request_stop(); };
  std::vector<double> heights(257 * 257);
  try {
    terrain.raster(request, [](const RasterBlock&) {});
    ADD_FAILURE() << "it was not stopped";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace ptin
