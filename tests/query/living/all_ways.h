// SPDX-License-Identifier: GPL-3.0-or-later
//
// One question asked by heights, by stars and by splits: the answers are the same, bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "engine/query/questions.h"

namespace ptin::reference {

/// Places of a raster, in map units: anywhere, on samples, on sides and diagonals of cells, in their
/// centres, on the borders of squares of `side` cells and of the raster, and outside.
[[nodiscard]] std::vector<MapPoint> places_of_raster(const StoreFacts& facts, std::int64_t side,
                                                     std::size_t count, std::mt19937_64& random);

/// How much is asked.
struct AllWays {
  std::size_t points = 400;  ///< Also one by one.
  std::size_t splits = 400;  ///< Of them by splits.
  std::size_t lines = 20;    ///< Profiles.
  std::size_t windows = 3;  ///< Beside the whole terrain; isolines, volumes, TINs, rasters of each.
  double window_share = 0.5;  ///< Their sides, at most, as a share of the terrain's.
  bool asks_whole = true;     ///< Ask for the whole terrain, too.
};
/// Fails where an answer by heights is another one by stars, or by splits.
/// REQUIRES: the file has heights.
void expect_same_by_all_ways(const Terrain& terrain, const AllWays& asked, std::uint64_t seed);

/// Fails where exact questions read more pages and nodes of heights than they should: a point one page
/// and a node of each level, a point on a sample 1.05 pages in the mean, a window 1.2 (sqrt(f) + 1)^2 in
/// the mean, where f pages hold its samples (of a terrain without voids).
/// REQUIRES: the file has heights.
void expect_few_reads(const Terrain& terrain, std::uint64_t seed);

/// Fails where a batch of points of the same file elsewhere gets other answers, or takes more than three
/// rounds: nodes and pages behind the root.
void expect_few_rounds(const Terrain& terrain, std::uint64_t seed);

}  // namespace ptin::reference
