// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters larger than memory, of which the first block comes; and what one costs that is the heights in the file.
#include <cstdint>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/query/raster/raster.h"
#include "tests/query/built_terrain.h"

namespace ptin {
namespace {

TEST(Raster, OfAnySizeIsHandedOverInBlocks) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  // Sizes whose bytes, and twice these, are small numbers when they wrap around.
  for (const std::int64_t height : {std::int64_t{1} << 30, std::int64_t{1'908'874'354}}) {
    const StoreFacts& facts = terrain.store().facts();
    RasterRequest request;
    request.lattice = {facts.map.to_map(facts.bounds.min_x, facts.bounds.max_y), facts.map.step_x,
                       -facts.map.step_y};
    request.pixels.column = request.pixels.row = -2;
    request.pixels.width = std::int64_t{1} << 30;
    request.pixels.height = height;
    request.states = height != std::int64_t{1} << 30;
    request.block_width = request.block_height = 64;
    std::stop_source stop;
    request.limits.stop = stop.get_token();
    const auto first = [&](const RasterBlock& block) {
      EXPECT_EQ(block.pixels.pixels(), request.block_width * request.block_height);
      stop.request_stop();
    };
    try {
      static_cast<void>(terrain.raster(request, first));
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled) << e.what();
    }
  }
}

TEST(FloorPixels, ReadNoPagesOfStarsWhereTheyAreSamples) {
  for (const char* name : {"coast_257.tif", "mountains_257.tif"}) {
    const Terrain& terrain = reference::built_terrain(name);
    ASSERT_NE(terrain.floor(), nullptr);
    const StoreFacts& facts = terrain.store().facts();
    RasterRequest request;
    request.lattice = {facts.map.to_map(0, 256), facts.map.step_x, -facts.map.step_y};
    request.pixels = {0, 0, 257, 257};
    std::vector<double> heights(257 * 257);
    const RasterResult result = terrain.raster(request, heights);
    EXPECT_EQ(result.cost.io.pages, terrain.floor()->pages()) << name;
    EXPECT_GE(result.cost.samples_read, 257U * 257U) << name;
    EXPECT_TRUE(result.exact);
    Terrain by_stars = terrain;
    by_stars.use_floor(false);
    EXPECT_EQ(by_stars.raster(request, heights).surface_pixels, result.surface_pixels) << name;
  }
}

}  // namespace
}  // namespace ptin
