// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/shape/tiler.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "engine/error.h"
#include "engine/geometry/hilbert.h"
#include "engine/query/shape/grid_cell.h"

namespace ptin {
namespace {

std::int64_t positions_in(const GridBox& b) {
  return (std::int64_t{b.max_x} - b.min_x + 1) * (std::int64_t{b.max_y} - b.min_y + 1);
}

TEST(WorkInParts, GoesThroughTheHalvesOfWhatDoesNotFitInTheirOrder) {
  const std::vector<int> row{0, 1, 2, 3, 4, 5, 6};
  std::vector<std::vector<int>> done;
  work_in_parts(std::span(row), [&](std::span<const int> part) {
    if (part.size() > 2) return false;
    done.emplace_back(part.begin(), part.end());
    return true;
  });
  EXPECT_EQ(done, (std::vector<std::vector<int>>{{0}, {1, 2}, {3, 4}, {5, 6}}));
}

TEST(WorkOnTiles, CoversTheDomainOnceOnAnyNumberOfThreads) {
  const GridBox domain{3, 5, 1002, 204};
  for (const int threads : {1, 3}) {
    const TileLimits limits{std::uint64_t{4000} * 3, 4000, threads};
    ASSERT_EQ(limits.workers(), threads);
    std::mutex mutex;
    std::vector<GridBox> done;
    work_on_tiles(domain, limits, [&](int worker, const GridTile& tile) {
      EXPECT_LT(worker, threads);
      if (static_cast<std::uint64_t>(positions_in(tile.box)) > tile.most_bytes) return false;
      const std::lock_guard lock(mutex);
      done.push_back(tile.box);
      return true;
    });
    std::int64_t positions = 0;
    for (std::size_t i = 0; i < done.size(); ++i) {
      EXPECT_TRUE(contains(domain, done[i]));
      positions += positions_in(done[i]);
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(meets(done[i], done[j]));
    }
    EXPECT_EQ(positions, positions_in(domain));
    EXPECT_GT(done.size(), 50U);
  }
}

TEST(WorkOnTiles, GivesASmallestTileAllThatItsWorkerHas) {
  const TileLimits limits{1000, 10, 1};
  bool was_smallest = false;
  work_on_tiles({0, 0, 63, 0}, limits, [&](int, const GridTile& tile) {
    EXPECT_EQ(tile.most_bytes, tile.is_smallest ? 1000U : 10U);
    was_smallest = was_smallest || tile.is_smallest;
    return tile.is_smallest;
  });
  EXPECT_TRUE(was_smallest);
}

TEST(WorkOnTiles, ThrowsWhatTheFirstTileThrewThatFailed) {
  for (const int threads : {1, 4}) {
    EXPECT_THROW(work_on_tiles({0, 0, 1023, 1023}, {1 << 20, 1 << 10, threads},
                               [](int, const GridTile& tile) -> bool {
                                 if (positions_in(tile.box) < 5000)
                                   throw Error(ErrorCode::io_error, "none", "here");
                                 return false;
                               }),
                 Error);
  }
}

TEST(TileLimits, StartsNoWorkerThatWouldHaveLessThanAQuarterOfATile) {
  EXPECT_EQ((TileLimits{1000, 400, 8}.workers()), 8);
  EXPECT_EQ((TileLimits{1000, 800, 8}.workers()), 5);
  EXPECT_EQ((TileLimits{1000, 800, 8}.worker_bytes()), 200U);
  EXPECT_EQ((TileLimits{10, 800, 8}.workers()), 1);
  EXPECT_EQ((TileLimits{10, 0, 0}.workers()), 1);
}

TEST(WorkOnCells, GoesAlongTheHilbertCurveAndTellsWhatIsDone) {
  const GridBox domain{5, 5, 40, 23};
  std::uint64_t last = 0;
  double done_last = 0.0;
  std::int64_t positions = 0;
  work_on_cells(domain, [&](const GridCell& cell, double share, double done) {
    EXPECT_EQ(share, std::ldexp(1.0, 2 * (cell.level - 6)));
    if (cell.level > 2) return false;
    const std::uint64_t along = hilbert_position(cell.x, cell.y) >> (2 * cell.level);
    EXPECT_TRUE(positions == 0 || along > last);
    EXPECT_GT(done, done_last);
    last = along;
    done_last = done;
    const GridBox b = cell.box();
    positions += positions_in({std::max(b.min_x, domain.min_x), std::max(b.min_y, domain.min_y),
                               std::min(b.max_x, domain.max_x), std::min(b.max_y, domain.max_y)});
    return true;
  });
  EXPECT_EQ(positions, positions_in(domain));
  EXPECT_EQ(done_last, 1.0);
}

}  // namespace
}  // namespace ptin
