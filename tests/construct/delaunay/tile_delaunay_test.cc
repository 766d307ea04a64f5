// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/delaunay/tile_delaunay.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/construct/delaunay/tiled_delaunay.h"
#include "tests/construct/point_sets.h"
#include "tests/support/share_of_cases.h"

namespace ptin {
namespace {

class EveryKind : public testing::TestWithParam<PointKind> {};

TEST_P(EveryKind, TilesAreOneTriangulation) {
  for (const std::uint64_t tiles : test::some_of<std::uint64_t>({1, 16, 64})) {
    expect_one_triangulation(buckets_of(GetParam(), 8000, 7), tiles);
  }
}

TEST_P(EveryKind, TilesOfFewPointsAreOneTriangulation) {
  for (const std::uint64_t n : test::some_of<std::uint64_t>({3, 4, 5, 17, 100, 1000})) {
    for (const std::uint64_t tiles : {2, 7, 64}) {
      expect_one_triangulation(buckets_of(GetParam(), n, n), tiles);
    }
  }
}

TEST_P(EveryKind, TilesThatRememberNoPointsAreOneTriangulation) {
  expect_one_triangulation(buckets_of(GetParam(), 4000, 11), 16, 0);
}

INSTANTIATE_TEST_SUITE_P(TileDelaunay, EveryKind, testing::ValuesIn(kPointKinds),
                         [](const auto& kind) { return name_of(kind.param); });

}  // namespace
}  // namespace ptin
