// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tile_delaunay.h"

#include <tuple>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/construct/delaunay.h"
#include "engine/error.h"
#include "tests/construct/point_sets.h"

namespace ptin {
namespace {

using Corners = std::array<std::uint64_t, 3>;

/// The triangles of a TIN by the keys of their corners, the smallest first.
std::vector<Corners> triangles_of(const Tin& tin) {
  std::vector<Corners> all;
  for (const Triangle& t : tin.triangles) {
    Corners c{key_of(tin.position(t.v[0])), key_of(tin.position(t.v[1])),
              key_of(tin.position(t.v[2]))};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    all.push_back(c);
  }
  return all;
}

std::uint64_t others = 0;

/// The triangles of all tiles of a set cut into `tiles` parts.
std::vector<Corners> tiled(const PointBuckets& buckets, std::uint64_t tiles) {
  DelaunayTiler tiler(buckets);
  std::vector<Corners> all;
  others = 0;
  for (std::uint64_t i = 0; i < tiles; ++i) {
    const std::uint64_t begin = buckets.size() * i / tiles, end = buckets.size() * (i + 1) / tiles;
    if (begin == end) {
      continue;
    }
    const DelaunayTile tile = tiler.make(begin, end - begin);
    const std::vector<Corners> part = triangles_of(tile.tin);
    all.insert(all.end(), part.begin(), part.end());
    others += tile.other_points;
  }
  return all;
}

/// The one triangulation of all points, in memory.
Tin whole(const PointBuckets& buckets) {
  std::vector<BucketPoint> points;
  buckets.take(0, buckets.size(), points);
  std::sort(points.begin(), points.end(), [](const BucketPoint& a, const BucketPoint& b) {
    return key_of(a.position) < key_of(b.position);
  });
  std::vector<GridPoint> positions;
  std::vector<HeightBits> heights;
  for (const BucketPoint& p : points) {
    positions.push_back(p.position);
    heights.push_back(p.height);
  }
  return make_delaunay_tin(positions, heights);
}

void expect_one_triangulation(const PointBuckets& buckets, std::uint64_t tiles) {
  std::vector<Corners> expected = triangles_of(whole(buckets)), found = tiled(buckets, tiles);
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  ASSERT_EQ(expected.size(), found.size()) << tiles << " tiles";
  ASSERT_TRUE(expected == found) << tiles << " tiles";
}

class EveryKind : public testing::TestWithParam<PointKind> {};

TEST_P(EveryKind, TilesAreOneTriangulation) {
  for (const std::uint64_t tiles : {1, 4, 16, 64}) {
    expect_one_triangulation(buckets_of(GetParam(), 20'000, 7), tiles);
  }
}

TEST_P(EveryKind, TilesOfFewPointsAreOneTriangulation) {
  for (const std::uint64_t n : {3, 4, 5, 17, 100, 1000}) {
    for (const std::uint64_t tiles : {2, 7, 64}) {
      expect_one_triangulation(buckets_of(GetParam(), n, n), tiles);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(TileDelaunay, EveryKind, testing::ValuesIn(kPointKinds),
                         [](const auto& kind) { return name_of(kind.param); });

}  // namespace
}  // namespace ptin
