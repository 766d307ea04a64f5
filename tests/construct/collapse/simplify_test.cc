// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every record of a simplified tile against its definition, on terrains of every kind.
#include "engine/construct/collapse/simplify.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/error.h"
#include "engine/mesh/star.h"
#include "engine/mesh/validate.h"
#include "tests/construct/record_oracle.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"

namespace ptin {
namespace {

using oracle::TestTerrain;

std::size_t hull_corners(const Tin& tin) {
  std::size_t corners = 0;
  Star star;
  for (VertexId v = 0; v < tin.vertices.size(); ++v) {
    walk_star(tin, v, star);
    corners += !star.closed && oracle::side(tin.position(star.link.back()), tin.position(v),
                                            tin.position(star.link.front())) != 0
                   ? 1
                   : 0;
  }
  return corners;
}

bool any_void(const TestTerrain& terrain) {
  return std::any_of(terrain.samples.begin(), terrain.samples.end(),
                     [](const oracle::PlainSample& s) { return !s.has_height; });
}

TEST(Simplify, RecordsOfNastyRastersAreThoseOfTheDefinition) {
  for (const auto& make : oracle::nasty_rasters()) {
    const TestTerrain terrain = oracle::simplified(make());
    EXPECT_EQ(oracle::check_records(terrain), "");
  }
}

TEST(Simplify, RecordsOfNastyPointsAreThoseOfTheDefinition) {
  for (const auto& make : oracle::nasty_points()) {
    const TestTerrain terrain = oracle::simplified(make());
    EXPECT_EQ(oracle::check_records(terrain), "");
  }
}

TEST(Simplify, OtherCostsKeepTheDefinitionToo) {
  for (const CostModel cost : {CostModel::kRoi, CostModel::kElevation}) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      const TestTerrain terrain = oracle::simplified(oracle::random_terrain(seed, 120), cost);
      EXPECT_EQ(oracle::check_records(terrain), "");
    }
  }
}

RC_GTEST_PROP(Simplify, RecordsOfRandomTerrainsAreThoseOfTheDefinition, (std::uint64_t seed)) {
  const TestTerrain terrain = oracle::simplified(oracle::random_terrain(seed, 90));
  RC_ASSERT(oracle::check_records(terrain) == "");
}

TEST(Simplify, LeavesFourVerticesOfARasterWithoutVoids) {
  for (const auto& make : oracle::nasty_rasters()) {
    const TestTerrain terrain = oracle::simplified(make());
    SCOPED_TRACE(terrain.name);
    const std::size_t left = terrain.tile.tin.alive_vertices();
    if (any_void(terrain)) {
      EXPECT_LE(left, 60U);
    } else {
      EXPECT_EQ(left, 4U);
    }
  }
}

TEST(Simplify, LeavesTheHullOfPoints) {
  for (const auto& make : oracle::nasty_points()) {
    const TestTerrain terrain = oracle::simplified(make());
    SCOPED_TRACE(terrain.name);
    EXPECT_EQ(terrain.tile.tin.alive_vertices(), hull_corners(terrain.full));
  }
}

TEST(Simplify, TellsWhenNothingIsLostByZero) {
  for (const auto& make : oracle::nasty_rasters()) {
    const TestTerrain terrain = oracle::simplified(make());
    if (terrain.name == "flat" || terrain.name == "tilted" ||
        terrain.name == "a tilted plane of floats") {
      for (const VertexSplit& r : terrain.tile.records) {
        EXPECT_EQ(r.error, 0.0F) << terrain.name;
      }
    }
  }
}

TEST(Simplify, StopsWhenAsManyAreLeftAsAreToBeKept) {
  for (const std::uint64_t keep : {4, 50, 199, 200, 5000}) {
    TestTerrain terrain = oracle::nasty_rasters()[9]();
    const std::size_t before = terrain.tile.tin.alive_vertices();
    SimplifyOptions options;
    options.keep = keep;
    simplify(terrain.tile, *terrain.surface, options);
    EXPECT_EQ(terrain.tile.tin.alive_vertices(), std::min<std::size_t>(keep, before));
    EXPECT_EQ(oracle::check_records(terrain), "");
  }
}

TEST(Simplify, GoesOnWhereItStopped) {
  TestTerrain terrain = oracle::nasty_rasters()[9]();
  for (const std::uint64_t keep : {300, 120, 30, 0}) {
    SimplifyOptions options;
    options.keep = keep;
    simplify(terrain.tile, *terrain.surface, options);
  }
  EXPECT_EQ(terrain.tile.tin.alive_vertices(), 4U);
  EXPECT_EQ(oracle::check_records(terrain), "");
}

TEST(Simplify, DoesNotDependOnArraysMadeShorter) {
  const auto both = [](const auto& make) {
    TestTerrain shortened = make();
    TestTerrain kept = make();
    SimplifyOptions options;
    options.compact_above = 0;
    simplify(shortened.tile, *shortened.surface, options);
    options.compact_above = SIZE_MAX;
    simplify(kept.tile, *kept.surface, options);
    SCOPED_TRACE(kept.name);
    EXPECT_EQ(shortened.tile.records, kept.tile.records);
    EXPECT_EQ(kept.tile.tin.vertices.size(), kept.full.vertices.size());
    EXPECT_LE(shortened.tile.tin.vertices.size(),
              std::max<std::size_t>(2 * kept.tile.tin.alive_vertices(), 4));
    EXPECT_EQ(oracle::named_triangles(shortened.tile.tin), oracle::named_triangles(kept.tile.tin));
    EXPECT_EQ(validate(shortened.tile.tin), "");
  };
  std::ranges::for_each(oracle::nasty_rasters(), both);
  std::ranges::for_each(oracle::nasty_points(), both);
}

TEST(Simplify, LeavesLockedVertices) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    TestTerrain terrain = oracle::random_terrain(seed, 120);
    std::mt19937_64 random(seed);
    std::vector<VertexId> locked;
    for (VertexId v = 0; v < terrain.full.vertices.size(); ++v) {
      if (random() % 6 == 0) {
        terrain.tile.vertex_state[v].locked = true;
        locked.push_back(v);
      }
    }
    simplify(terrain.tile, *terrain.surface, {});
    for (const VertexId v : locked) {
      EXPECT_NE(terrain.tile.tin.vertices[v].triangle, kNone);
    }
    EXPECT_EQ(oracle::check_records(terrain), "");
  }
}

TEST(Simplify, KeepsCountOfDegrees) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    TestTerrain terrain = oracle::random_terrain(seed, 200);
    SimplifyOptions options;
    options.keep = 40;
    simplify(terrain.tile, *terrain.surface, options);
    Star star;
    for (VertexId v = 0; v < terrain.full.vertices.size(); ++v) {
      if (terrain.tile.tin.vertices[v].triangle != kNone) {
        walk_star(terrain.tile.tin, v, star);
        EXPECT_EQ(terrain.tile.vertex_state[v].degree, star.degree()) << terrain.name;
      }
    }
  }
}

TEST(Simplify, GivesTheSameRecordsTwice) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TestTerrain first = oracle::simplified(oracle::random_terrain(seed, 150));
    const TestTerrain second = oracle::simplified(oracle::random_terrain(seed, 150));
    EXPECT_TRUE(first.tile.records == second.tile.records);
  }
}

TEST(Simplify, IsCancelledByItsToken) {
  TestTerrain terrain = oracle::make_raster(
      {"flat", 80, 80, [](int, int) { return 0.0; }, {}, {HeightType::int32, 1.0, 0.0}, {}, 0.1});
  std::stop_source source;
  SimplifyOptions options;
  options.stop = source.get_token();
  std::uint64_t calls = 0;
  options.progress = [&](std::uint64_t) {
    ++calls;
    source.request_stop();
  };
  try {
    simplify(terrain.tile, *terrain.surface, options);
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(calls, 1U);
}

}  // namespace
}  // namespace ptin
