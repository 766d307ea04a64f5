// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rasters against locate(), against the triangles in rationals, and against themselves cut otherwise.
#include "engine/query/raster/raster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/query/questions.h"
#include "engine/query/raster/pixel_centres.h"
#include "engine/query/raster/pixel_normals.h"
#include "tests/query/built_terrain.h"
#include "tests/query/line_oracle.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

using reference::Hierarchy;
using reference::same_number;
using reference::TemporaryStore;

std::size_t pixels_of(const RasterRequest& request) {
  return static_cast<std::size_t>(request.pixels.pixels());
}

MapPoint centre_of(const RasterRequest& request, std::size_t i) {
  const auto place = static_cast<std::int64_t>(i);
  return request.lattice.centre(request.pixels.column + place % request.pixels.width,
                                request.pixels.row + place / request.pixels.width);
}

/// Steps of the grid, halves and thirds of them, and any others; towards any side.
double random_step(std::mt19937_64& random, double extent) {
  const std::array<double, 8> steps{1, 1, 2, 0.5, 0.25, 1.0 / 3, 7, 0};
  double step = steps[random() % steps.size()];
  if (step == 0) step = std::uniform_real_distribution<double>(0.02, 0.3)(random) * extent;
  return random() % 2 == 0 ? step : -step;
}

/// Pixels around a vertex of the TIN, or anywhere, on it and beyond.
RasterRequest random_request(std::mt19937_64& random, const Hierarchy& h) {
  const GridBox& b = h.facts.bounds;
  RasterRequest request;
  request.lattice.step_x = random_step(random, b.max_x - b.min_x) * h.facts.map.step_x;
  request.lattice.step_y = random_step(random, b.max_y - b.min_y) * h.facts.map.step_y;
  const GridPoint v = h.full.vertices[random() % h.full.vertices.size()].position;
  request.lattice.origin = h.facts.map.to_map(v.x, v.y);
  if (random() % 3 == 0) {
    std::uniform_real_distribution<double> off(-3.0, 3.0);
    request.lattice.origin = h.facts.map.to_map(v.x + off(random), v.y + off(random));
  }
  const auto below = [&](std::uint64_t n) { return static_cast<std::int64_t>(random() % n); };
  request.pixels = {below(12) - 9, below(12) - 9, 1 + below(17), 1 + below(17)};
  return request;
}

DetailRequest random_detail(std::mt19937_64& random, const Hierarchy& h) {
  DetailRequest detail;
  if (random() % 3 == 0) {
    detail.tolerance = h.records.empty() ? 1.0 : h.records[random() % h.records.size()].error;
  } else if (random() % 2 == 0) {
    detail.vertices = h.t0.vertices.size() + random() % (h.records.size() + 1);
  }
  return detail;
}

struct Pixels {
  std::vector<double> heights;
  std::vector<PointState> states;
};

Pixels filled(const Terrain& terrain, const RasterRequest& request) {
  Pixels pixels{std::vector<double>(pixels_of(request)),
                std::vector<PointState>(pixels_of(request))};
  static_cast<void>(terrain.raster(request, pixels.heights, pixels.states));
  return pixels;
}

/// The same put together from blocks.
Pixels gathered(const Terrain& terrain, RasterRequest request) {
  Pixels pixels{std::vector<double>(pixels_of(request), -1.0),
                std::vector<PointState>(pixels_of(request))};
  request.states = true;
  static_cast<void>(terrain.raster(request, [&](const RasterBlock& block) {
    for (std::int64_t y = 0; y < block.pixels.height; ++y) {
      const std::size_t from = static_cast<std::size_t>(y) * block.stride;
      const auto to = static_cast<std::size_t>((block.pixels.row - request.pixels.row + y) *
                                                   request.pixels.width +
                                               block.pixels.column - request.pixels.column);
      for (std::size_t x = 0; x < static_cast<std::size_t>(block.pixels.width); ++x) {
        pixels.heights[to + x] = block.heights[from + x];
        pixels.states[to + x] = block.states[from + x];
      }
    }
  }));
  return pixels;
}

RC_GTEST_PROP(Raster, GivesWhatLocateGivesAtTheCentres, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  for (int i = 0; i < 6; ++i) {
    RasterRequest request = random_request(random, h);
    request.detail = random_detail(random, h);
    const Pixels pixels = filled(terrain, request);
    std::vector<MapPoint> centres;
    for (std::size_t k = 0; k < pixels_of(request); ++k) centres.push_back(centre_of(request, k));
    LocateRequest points;
    points.detail = request.detail;
    const LocateResult located = terrain.locate(centres, points);
    request.block_width = 1 + static_cast<std::int64_t>(random() % 9);
    request.block_height = 1 + static_cast<std::int64_t>(random() % 9);
    request.limits.memory_bytes = request.detail.vertices ? 1'000'000 : 3'000;
    const Pixels blocks = gathered(terrain, request);
    for (std::size_t k = 0; k < centres.size(); ++k) {
      RC_ASSERT(pixels.states[k] == located.points[k].state);
      RC_ASSERT(same_number(pixels.heights[k], located.points[k].height));
      RC_ASSERT(blocks.states[k] == pixels.states[k]);
      RC_ASSERT(same_number(blocks.heights[k], pixels.heights[k]));
    }
  }
}

RC_GTEST_PROP(Raster, GivesTheHeightOfTheTriangleBelow, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  const SpotMap map(h.facts.map, h.facts.bounds);
  RasterRequest request = random_request(random, h);
  request.pixels.width = request.pixels.height = 5;
  const Pixels pixels = filled(terrain, request);
  for (std::size_t k = 0; k < pixels_of(request); ++k) {
    const reference::RationalPoint at = reference::rational_of(*map.spot(centre_of(request, k)));
    const std::vector<TriangleId> triangles = reference::triangles_at(h.full, at);
    if (triangles.empty()) {
      RC_ASSERT(pixels.states[k] == PointState::kOutside);
      RC_ASSERT(std::isnan(pixels.heights[k]));
      continue;
    }
    const TriangleId t = reference::answering_among(h.full, triangles);
    const bool is_surface = h.full.classes[t] == TriangleClass::kSurface;
    RC_ASSERT(pixels.states[k] == (is_surface ? PointState::kSurface : PointState::kVoid));
    RC_ASSERT(std::isnan(pixels.heights[k]) == !is_surface);
    if (!is_surface) continue;
    const HeightEncoding& heights = h.facts.heights;
    const reference::Rational exact =
        reference::Rational(heights.offset) +
        reference::Rational(heights.step) * reference::code_on(h.full, heights, t, at);
    RC_ASSERT(abs(reference::Rational(pixels.heights[k]) - exact) <= reference::Rational(1e-11));
  }
}

RC_GTEST_PROP(Raster, GivesVerticesTheirHeightsBitForBit, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Hierarchy h = reference::random_hierarchy(seed);
  const TemporaryStore file(h);
  const Terrain terrain(file.open());
  const GridBox& b = h.facts.bounds;
  std::map<std::pair<std::int32_t, std::int32_t>, VertexId> vertices;
  for (VertexId v = 0; v < h.full.vertices.size(); ++v) {
    vertices[{h.full.position(v).x, h.full.position(v).y}] = v;
  }
  for (const double sign : {1.0, -1.0}) {
    RasterRequest request;
    request.lattice.step_x = h.facts.map.step_x;
    request.lattice.step_y = sign * h.facts.map.step_y;
    request.pixels = {0, 0, std::min(b.max_x - b.min_x + 1, 200),
                      std::min(b.max_y - b.min_y + 1, 200)};
    const std::int32_t first_y = sign > 0 ? b.min_y : b.max_y;
    request.lattice.origin = h.facts.map.to_map(b.min_x, first_y);
    const Pixels pixels = filled(terrain, request);
    for (std::int32_t row = 0; row < request.pixels.height; ++row) {
      for (std::int32_t column = 0; column < request.pixels.width; ++column) {
        const auto found =
            vertices.find({b.min_x + column, first_y + static_cast<std::int32_t>(sign) * row});
        const auto k = static_cast<std::size_t>(row * request.pixels.width + column);
        if (found == vertices.end() || std::isnan(pixels.heights[k])) continue;
        RC_ASSERT(pixels.heights[k] ==
                  h.facts.heights.height(h.full.vertices[found->second].height));
      }
    }
  }
}

/// A raster over the whole terrain and a little beyond.
RasterRequest whole_request(const Terrain& terrain, double steps) {
  const StoreFacts& f = terrain.store().facts();
  RasterRequest request;
  request.lattice.origin = f.map.to_map(f.bounds.min_x, f.bounds.max_y);
  request.lattice.step_x = f.map.step_x * steps;
  request.lattice.step_y = -f.map.step_y * steps;
  const auto side = [&](std::int32_t extent) {
    return static_cast<std::int64_t>(extent / steps) + 5;
  };
  request.pixels = {-2, -2, side(f.bounds.max_x - f.bounds.min_x),
                    side(f.bounds.max_y - f.bounds.min_y)};
  return request;
}

TEST(Raster, OfAnyPartIsCutFromTheWhole) {
  for (const char* name : {"coast_257.tif", "ground_points.csv"}) {
    const Terrain& terrain = reference::built_terrain(name);
    const GridBox& b = terrain.store().facts().bounds;
    const RasterRequest whole = whole_request(terrain, (b.max_x - b.min_x) / 301.7);
    const Pixels all = filled(terrain, whole);
    RasterRequest part = whole;
    part.pixels = {37, 51, 83, 5};
    const Pixels cut = filled(terrain, part);
    for (std::size_t k = 0; k < cut.heights.size(); ++k) {
      const auto at = static_cast<std::int64_t>(k);
      const auto in_whole = static_cast<std::size_t>(
          (part.pixels.row - whole.pixels.row + at / 83) * whole.pixels.width + part.pixels.column -
          whole.pixels.column + at % 83);
      ASSERT_TRUE(same_number(cut.heights[k], all.heights[in_whole])) << name << " " << k;
      ASSERT_EQ(cut.states[k], all.states[in_whole]) << name << " " << k;
    }
  }
}

TEST(Raster, OfFewPixelsReadsFewPages) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  RasterRequest request = whole_request(terrain, 1);
  const Pixels all = filled(terrain, request);
  const std::int64_t columns = request.pixels.width;
  request.lattice.origin = centre_of(request, static_cast<std::size_t>(columns * 31 + 17));
  request.lattice.step_x *= 64;
  request.lattice.step_y *= 64;
  request.pixels = {0, 0, 3, 3};
  std::vector<double> few(9);
  std::vector<PointState> states(9);
  const RasterResult result = terrain.raster(request, few, states);
  for (std::size_t k = 0; k < 9; ++k) {
    const std::size_t in_all =
        (31 + 64 * (k / 3)) * static_cast<std::size_t>(columns) + 17 + 64 * (k % 3);
    EXPECT_EQ(few[k], all.heights[in_all]) << k;
    EXPECT_EQ(states[k], all.states[in_all]) << k;
  }
  EXPECT_LT(result.cost.io.pages, terrain.store().pages().page_count() / 2);
}

TEST(Raster, HandsBlocksOverInTheOrderOfHalving) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  RasterRequest request = whole_request(terrain, 1.7);
  request.block_width = 64;
  request.block_height = 32;
  const auto order = [&](std::uint64_t memory) {
    request.limits.memory_bytes = memory;
    std::vector<PixelRect> blocks;
    static_cast<void>(
        terrain.raster(request, [&](const RasterBlock& block) { blocks.push_back(block.pixels); }));
    return blocks;
  };
  const std::vector<PixelRect> blocks = order(std::uint64_t{1} << 30);
  std::int64_t pixels = 0;
  for (const PixelRect& block : blocks) pixels += block.pixels();
  EXPECT_EQ(pixels, request.pixels.pixels());
  EXPECT_EQ(blocks.front(), (PixelRect{-2, -2, 64, 32}));
  EXPECT_EQ(order(40'000), blocks);
}

TEST(Raster, TellsOfItsProgressAndCertificate) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  RasterRequest request = whole_request(terrain, 3);
  request.detail.tolerance = 4.0;
  std::vector<double> shares;
  request.progress = [&](double share) { shares.push_back(share); };
  std::vector<double> heights(pixels_of(request));
  const RasterResult result = terrain.raster(request, heights);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.size(), 10U);
  EXPECT_EQ(shares.back(), 1.0);
  EXPECT_EQ(result.detail.tolerance, 4.0);
  EXPECT_FALSE(result.exact);
  EXPECT_LE(result.certified_error, 4.0);
  EXPECT_GT(result.certified_error, 2.0);
  EXPECT_EQ(result.surface_pixels,
            static_cast<std::uint64_t>(std::count_if(heights.begin(), heights.end(),
                                                     [](double v) { return !std::isnan(v); })));
  request.detail = {};
  EXPECT_TRUE(terrain.raster(request, heights).exact);
}

TEST(Raster, StopsWhenAskedTo) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  RasterRequest request = whole_request(terrain, 1);
  std::stop_source stop;
  request.limits.stop = stop.get_token();
  request.progress = [&](double) { stop.request_stop(); };
  std::vector<double> heights(pixels_of(request));
  try {
    static_cast<void>(terrain.raster(request, heights));
    FAIL() << "nothing was thrown";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
}

TEST(Raster, TakesCentresWithinTheMarginOntoTheBorder) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const StoreFacts& f = terrain.store().facts();
  RasterRequest request = whole_request(terrain, 1);
  request.lattice.origin.x -= 0.5 * f.map.step_x;
  request.lattice.origin.y += 0.25 * f.map.step_y;
  const Pixels without = filled(terrain, request);
  request.lattice.margin = {0.5 * f.map.step_x, 0.5 * f.map.step_y};
  const Pixels with = filled(terrain, request);
  for (std::size_t k = 0; k < without.heights.size(); ++k) {
    if (without.states[k] != PointState::kOutside) {
      ASSERT_EQ(without.heights[k], with.heights[k]);
    }
  }
  // The pixel of the north-western corner stands half a step to the west and a quarter to the north.
  const auto corner = static_cast<std::size_t>(2 * request.pixels.width + 2);
  EXPECT_EQ(without.states[corner], PointState::kOutside);
  const MapPoint at = f.map.to_map(f.bounds.min_x, f.bounds.max_y);
  EXPECT_EQ(with.heights[corner], terrain.locate({&at, 1}, {}).points[0].height);
}

TEST(Raster, RefusesWhatMeansNothing) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  const auto refused = [&](const std::string& words, const auto& change,
                           ErrorCode code = ErrorCode::invalid_argument) {
    RasterRequest request = whole_request(terrain, 10);
    change(request);
    try {
      static_cast<void>(terrain.raster(request, [](const RasterBlock&) {}));
      ADD_FAILURE() << "not refused: " << words;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code) << e.what();
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  };
  using Request = RasterRequest;
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  refused("step is 0", [](Request& r) { r.lattice.step_x = 0; });
  refused("not a finite number", [](Request& r) { r.lattice.step_y = kNoNumber; });
  refused("not a finite number", [](Request& r) { r.lattice.origin.x = HUGE_VAL; });
  refused("0 x 30 pixels", [](Request& r) { r.pixels.width = 0; });
  refused("from 1 to 2^31 - 1", [](Request& r) { r.pixels.height = std::int64_t{1} << 31; });
  refused("from -2^53 to 2^53", [](Request& r) { r.pixels.column = INT64_MAX; });
  refused("from -2^53 to 2^53", [](Request& r) { r.pixels.row = INT64_MIN; });
  refused("sides of at least 1", [](Request& r) { r.block_width = 0; });
  refused("margin", [](Request& r) { r.lattice.margin.y = -1; });
  refused("ask for one", [](Request& r) { r.as_fine_as_pixels = true, r.detail.vertices = 100; });
  refused("tolerance", [](Request& r) { r.detail.tolerance = -1; });
  refused(
      "more than the limit", [](Request& r) { r.limits.memory_bytes = 1000; },
      ErrorCode::resource_exhausted);
}

TEST(Raster, LiesOutsideWhereNoTerrainCanBe) {
  const Terrain& terrain = reference::built_terrain("mountains_257.tif");
  for (const double step : {1e30, 1e-30}) {
    RasterRequest request;
    request.lattice.origin = {-1e12, 5.0};
    request.lattice.step_x = request.lattice.step_y = step;
    request.pixels = {0, 0, 40, 40};
    const Pixels pixels = filled(terrain, request);
    EXPECT_EQ(std::count(pixels.states.begin(), pixels.states.end(), PointState::kOutside), 1600);
  }
}

TEST(Raster, GivesNormalsThatDoNotDependOnMemory) {
  const Terrain& terrain = reference::built_terrain("coast_257.tif");
  RasterRequest request = whole_request(terrain, 1);
  request.normals = true;
  request.block_width = request.block_height = 32;
  const auto normals_within = [&](std::uint64_t memory) {
    request.limits.memory_bytes = memory;
    std::vector<GridNormal> all(pixels_of(request));
    const RasterResult result = terrain.raster(request, [&](const RasterBlock& block) {
      for (std::int64_t y = 0; y < block.pixels.height; ++y) {
        for (std::int64_t x = 0; x < block.pixels.width; ++x) {
          const std::size_t from =
              static_cast<std::size_t>(y) * block.stride + static_cast<std::size_t>(x);
          EXPECT_EQ(block.normals[from].z > 0, !std::isnan(block.heights[from]));
          all[static_cast<std::size_t>((block.pixels.row + 2 + y) * request.pixels.width +
                                       block.pixels.column + 2 + x)] = block.normals[from];
        }
      }
    });
    EXPECT_GT(result.surface_pixels, 20'000U);
    return all;
  };
  const std::vector<GridNormal> much = normals_within(std::uint64_t{1} << 30);
  const std::vector<GridNormal> little = normals_within(400'000);
  for (std::size_t k = 0; k < much.size(); ++k) {
    ASSERT_EQ(much[k].x, little[k].x) << k;
    ASSERT_EQ(much[k].y, little[k].y) << k;
    ASSERT_EQ(much[k].z, little[k].z) << k;
  }
}

TEST(PixelNormals, AddInOneOrder) {
  // Sums of such heights depend on their order in the last bits.
  std::mt19937_64 random(3);
  StoreFacts facts;
  facts.bounds = {0, 0, 8, 8};
  std::vector<LivingTriangle> triangles;
  std::array<float, 81> heights{};
  for (float& h : heights) {
    h = std::ldexp(static_cast<float>(random() % 1000), static_cast<int>(random() % 40) - 20);
  }
  const auto corner = [&](int x, int y) {
    return LivingTriangle::Corner{
        {x, y}, std::bit_cast<HeightBits>(heights[static_cast<std::size_t>(9 * y + x)]), true};
  };
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      LivingTriangle t;
      t.corner = {corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)};
      triangles.push_back(t);
      t.corner = {corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)};
      triangles.push_back(t);
    }
  }
  const PixelCentres centres(facts, {{0, 0}, 1, 1, {}}, {0, 0, 9, 9});
  const auto summed = [&] {
    PixelNormals sums(facts, centres);
    for (const LivingTriangle& t : triangles) sums.add(t);
    std::vector<GridNormal> normals(81);
    sums.sum_up(normals, 9);
    return normals;
  };
  const std::vector<GridNormal> first = summed();
  std::shuffle(triangles.begin(), triangles.end(), random);
  for (LivingTriangle& t : triangles)
    std::rotate(t.corner.begin(), t.corner.begin() + 1, t.corner.end());
  const std::vector<GridNormal> second = summed();
  for (std::size_t k = 0; k < 81; ++k) {
    ASSERT_EQ(first[k].x, second[k].x) << k;
    ASSERT_EQ(first[k].y, second[k].y) << k;
    ASSERT_EQ(first[k].z, second[k].z) << k;
    ASSERT_GT(first[k].z, 0) << k;
  }
}

/// A long edge whose ends have odd coordinates, and corners far off on both sides.
TEST(Raster, HasOneHeightFromBothSidesOfALongEdge) {
  StoreFacts facts;
  facts.bounds = {0, 0, kGridMax, kGridMax};
  facts.heights = {HeightType::float32, 1.0, 0.0};
  const auto corner = [](int x, int y, float h) {
    return LivingTriangle::Corner{{x, y}, std::bit_cast<HeightBits>(h), true};
  };
  std::mt19937_64 random(11);
  for (int i = 0; i < 200; ++i) {
    const auto off = [&] { return static_cast<int>(random() % 100'000'000); };
    const int way = 3 * (100'000'001 + off());
    LivingTriangle above, below;
    above.corner = {corner(0, 500'000'000, 0.1F), corner(way, 500'000'000, 771.3F),
                    corner(off(), 500'000'001 + off(), 33.0F)};
    below.corner = {above.corner[1], above.corner[0], corner(off(), 499'999'999 - off(), -5.0F)};
    const PixelCentres centres(facts, {{0, 500'000'000}, way / 7.3, 1, {}}, {0, 0, 7, 1});
    const auto heights_of = [&](const LivingTriangle& t) {
      std::vector<double> heights(7);
      PixelSampler<double> sampler(facts, centres, {heights});
      sampler.add(t);
      return heights;
    };
    ASSERT_EQ(heights_of(above), heights_of(below));
    ASSERT_FALSE(std::isnan(heights_of(above)[5]));
  }
}

}  // namespace
}  // namespace ptin
