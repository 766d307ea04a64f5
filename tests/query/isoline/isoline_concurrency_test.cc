// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles traced by several threads at once give the lines of one thread; a failure in one of them
// ends all.
#include <random>
#include <system_error>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>

#include "engine/error.h"
#include "engine/query/isoline/isoline_tiles.h"
#include "engine/query/questions.h"
#include "tests/query/reference_hierarchy.h"

namespace ptin {
namespace {

struct StoredTerrain {
  StoredTerrain() : hierarchy(make()), file(hierarchy), tin(file.open()) {}
  static reference::Hierarchy make() {
    std::mt19937_64 random(7);
    Tin full = reference::random_grid(random, 70, 60, 8, 0.05);
    return reference::simplify_unmeasured(std::move(full), random);
  }
  [[nodiscard]] std::vector<double> levels() const {
    const StoreFacts& f = hierarchy.facts;
    std::vector<double> levels;
    for (int i = 1; i < 9; ++i) {
      levels.push_back(f.min_height + (f.max_height - f.min_height) * i / 9);
    }
    return levels;
  }
  reference::Hierarchy hierarchy;
  reference::TemporaryStore file;
  Terrain tin;
};

/// The lines in their order, and how many tiles they come from.
std::pair<std::vector<std::vector<MapPoint>>, std::uint64_t> traced(
    const StoredTerrain& terrain, int threads, std::uint64_t tile_bytes,
    std::uint64_t piece_bytes = 64 << 20) {
  const LevelSet levels(terrain.levels(), terrain.hierarchy.facts.heights);
  const Detail detail(terrain.tin.store());
  const TileTraceRequest request{levels,      detail, nullptr, {256 << 20, tile_bytes, threads},
                                 piece_bytes, {}};
  PointStore points(64 << 20, {});
  QueryCost cost;
  const TileTraces traces = trace_tiles(terrain.tin, request, points, cost);
  const JoinedLines joined =
      join_pieces(traces.pieces, QueryContext({.memory_bytes = 1 << 30}, "test"));
  std::vector<std::vector<MapPoint>> lines(joined.lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    points_of(joined.lines[i], joined, traces.pieces, points, lines[i]);
  }
  return {lines, traces.tiles};
}

TEST(IsolineTiles, GiveTheSameLinesOnAnyNumberOfThreads) {
  const StoredTerrain terrain;
  const auto [whole, one] = traced(terrain, 1, 1 << 30);
  EXPECT_EQ(one, 1U);
  EXPECT_GT(whole.size(), 100U);
  for (const int threads : {1, 2, 4, 7}) {
    const auto [lines, tiles] = traced(terrain, threads, 200'000);
    EXPECT_GT(tiles, 4U);
    EXPECT_TRUE(lines == whole) << threads << " threads, " << tiles << " tiles";
  }
}

/// No thread can be started while it lives: their stacks would be larger than the address space.
class NoMoreThreads {
 public:
  NoMoreThreads() {
    pthread_attr_t attributes;
    pthread_getattr_default_np(&attributes);
    pthread_attr_getstacksize(&attributes, &before_);
    pthread_attr_destroy(&attributes);
    set_stack(std::size_t{1} << 48);
  }
  NoMoreThreads(const NoMoreThreads&) = delete;
  NoMoreThreads& operator=(const NoMoreThreads&) = delete;
  ~NoMoreThreads() { set_stack(before_); }

 private:
  static void set_stack(std::size_t bytes) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, bytes);
    EXPECT_EQ(pthread_setattr_default_np(&attributes), 0);
    pthread_attr_destroy(&attributes);
  }
  std::size_t before_ = 0;
};

TEST(IsolineTiles, AreTracedByTheThreadsThatCanBeStarted) {
  const StoredTerrain terrain;
  const auto [whole, one] = traced(terrain, 1, 1 << 30);
  const NoMoreThreads limit;
  EXPECT_THROW(std::jthread([] {}), std::system_error);
  const auto [lines, tiles] = traced(terrain, 4, 200'000);
  EXPECT_GT(tiles, 4U);
  EXPECT_TRUE(lines == whole);
}

TEST(IsolineTiles, EndWhenOneOfThemFails) {
  const StoredTerrain terrain;
  for (const int threads : {1, 4}) {
    try {
      static_cast<void>(traced(terrain, threads, 200'000, 50 * kBytesAPiece));
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::resource_exhausted);
      EXPECT_NE(error.message().find("more than 50 pieces"), std::string::npos) << error.message();
    }
  }
}

}  // namespace
}  // namespace ptin
