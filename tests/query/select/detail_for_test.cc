// SPDX-License-Identifier: GPL-3.0-or-later
//
// The level for so many vertices, against counting the vertices of the TIN.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/query/questions.h"
#include "tests/query/built_terrain.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

Window window_of(const StoreFacts& facts) {
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  return {low.x, low.y, high.x, high.y};
}

/// Vertices of the level in a window, by looking at all of them.
std::uint64_t vertices_in(const Terrain& terrain, const DetailRequest& detail, const Window& w) {
  const AffineMap& map = terrain.store().facts().map;
  RefineRequest request;
  request.detail = detail;
  const RefinedTin refined = terrain.refine(request);
  return static_cast<std::uint64_t>(
      std::count_if(refined.tin.vertices.begin(), refined.tin.vertices.end(), [&](const Vertex& v) {
        const MapPoint p = map.to_map(v.position.x, v.position.y);
        return v.triangle != kNone && w.min_x <= p.x && p.x <= w.max_x && w.min_y <= p.y &&
               p.y <= w.max_y;
      }));
}

DetailRequest level_for(const Terrain& terrain, std::uint64_t vertices, const Window& window) {
  IoCounters io;
  const DetailRequest detail = detail_for(terrain.store(), vertices, window, io);
  EXPECT_EQ(io.pages, 0U);
  return detail;
}

/// The next finer level of the table of errors; the full TIN behind the last one.
DetailRequest finer(const Terrain& terrain, const DetailRequest& detail) {
  double below = -1.0;
  for (const ErrorBin& bin : terrain.store().error_bins()) {
    if (detail.tolerance && bin.upper < *detail.tolerance) below = bin.upper;
  }
  DetailRequest request;
  if (below >= 0) request.tolerance = below;
  return request;
}

TEST(DetailFor, KeepsAsManyVerticesOfAWholeTerrainAsItMay) {
  for (const char* name : test::some_of({"mountains_257.tif", "coast_257.tif"})) {
    const Terrain& terrain = reference::built_terrain(name);
    const Window whole = window_of(terrain.store().facts());
    const DetailRequest coarsest = level_for(terrain, 0, whole);
    EXPECT_TRUE(std::isfinite(coarsest.tolerance.value()));
    const std::uint64_t least = vertices_in(terrain, coarsest, whole);
    EXPECT_LT(least, 10U);
    for (const std::uint64_t vertices : {4U, 50U, 400U, 5'000U, 20'000U, 1'000'000U}) {
      const DetailRequest detail = level_for(terrain, vertices, whole);
      EXPECT_LE(vertices_in(terrain, detail, whole), std::max<std::uint64_t>(vertices, least))
          << name;
      if (detail.tolerance) {
        EXPECT_GT(vertices_in(terrain, finer(terrain, detail), whole), vertices) << name;
      }
    }
    const std::uint64_t all = terrain.store().t0().vertices.size() + terrain.store().record_count();
    EXPECT_FALSE(level_for(terrain, all, whole).tolerance);
    EXPECT_EQ(level_for(terrain, all - 1, whole).tolerance, 0.0);
  }
}

/// A coast: one part of it is flat, and another is not there. Even density would be off by ten.
TEST(DetailFor, WeighsWindowsByWhatIsInThem) {
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    const Terrain& terrain = reference::built_terrain(name);
    const Window all = window_of(terrain.store().facts());
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    for (int i = 0; i < 8; ++i) {
      const double side = 0.25 + 0.3 * place(random);
      const double width = (all.max_x - all.min_x) * side, height = (all.max_y - all.min_y) * side;
      const double x = all.min_x + place(random) * (all.max_x - all.min_x - width);
      const double y = all.min_y + place(random) * (all.max_y - all.min_y - height);
      const Window window{x, y, x + width, y + height};
      // From about two pages of records on: what is estimated is shares of pages.
      for (const std::uint64_t vertices : {400U, 1'500U}) {
        const DetailRequest detail = level_for(terrain, vertices, window);
        const auto counted = static_cast<double>(vertices_in(terrain, detail, window));
        EXPECT_LT(counted, 2.0 * static_cast<double>(vertices)) << name << " " << i;
        if (detail.tolerance) {
          const auto more =
              static_cast<double>(vertices_in(terrain, finer(terrain, detail), window));
          EXPECT_GT(more, 0.5 * static_cast<double>(vertices)) << name << " " << i;
        }
      }
    }
  }
}

TEST(DetailFor, IsTheFullTinWhereNothingIsToBeSeen) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const Window all = window_of(terrain.store().facts());
  EXPECT_FALSE(level_for(terrain, 10, {all.max_x + 1e5, all.max_y, all.max_x + 2e5, all.max_y + 1})
                   .tolerance);
}

TEST(DetailFor, HasNoGreaterErrorThanIsAllowed) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const Window all = window_of(terrain.store().facts());
  IoCounters io;
  const auto level = [&](std::uint64_t vertices, double most_error) {
    return detail_for(terrain.store(), vertices, all, io, most_error).tolerance;
  };
  const double free = level(100, kInfinity).value();
  EXPECT_EQ(level(100, free), free);
  EXPECT_LT(level(100, free / 10).value(), free / 10 + 1e-12);
  EXPECT_EQ(level(1, kInfinity), level(0, kInfinity));
  EXPECT_TRUE(std::isfinite(level(0, kInfinity).value())) << "fewer vertices than T0 has";
  EXPECT_FALSE(level(100, -1.0)) << "nothing but the full TIN";
}

TEST(DetailFor, IsTheLevelOfARasterAsFineAsItsPixels) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& facts = terrain.store().facts();
  const Window all = window_of(facts);
  RasterRequest request;
  request.lattice = {
      {all.min_x, all.max_y}, (all.max_x - all.min_x) / 40, -(all.max_y - all.min_y) / 40};
  request.pixels = {0, 0, 41, 41};  // half a pixel of each lies beside the terrain
  request.as_fine_as_pixels = true;
  std::vector<double> heights(41 * 41);
  const RasterResult result = terrain.raster(request, heights);
  EXPECT_EQ(result.detail.tolerance, level_for(terrain, 41 * 41, all).tolerance);
  EXPECT_GT(result.certified_error, 0);
  request.as_fine_as_pixels = false;
  request.detail = result.detail;
  std::vector<double> again(41 * 41);
  static_cast<void>(terrain.raster(request, again));
  EXPECT_EQ(heights, again);
}

}  // namespace
}  // namespace ptin
