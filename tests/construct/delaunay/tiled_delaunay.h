// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tiles of points against the one triangulation of all of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/delaunay/tile_delaunay.h"
#include "engine/construct/points/point_buckets.h"
#include "tests/construct/delaunay_tin.h"

namespace ptin {

using KeyTriangle = std::array<std::uint64_t, 3>;

/// The triangles of a TIN by the keys of their corners, the smallest first.
inline std::vector<KeyTriangle> triangles_of(const Tin& tin) {
  std::vector<KeyTriangle> all;
  for (const Triangle& t : tin.triangles) {
    KeyTriangle c{key_of(tin.position(t.v[0])), key_of(tin.position(t.v[1])),
                  key_of(tin.position(t.v[2]))};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    all.push_back(c);
  }
  return all;
}

/// The triangles of all tiles of a set cut into `tiles` parts.
inline std::vector<KeyTriangle> tiled(const PointBuckets& buckets, std::uint64_t tiles,
                                      std::size_t cache_bytes = std::size_t{16} << 20) {
  DelaunayTiler tiler(buckets, {}, cache_bytes);
  std::vector<KeyTriangle> all;
  for (std::uint64_t i = 0; i < tiles; ++i) {
    const std::uint64_t begin = buckets.size() * i / tiles, end = buckets.size() * (i + 1) / tiles;
    if (begin == end) {
      continue;
    }
    const DelaunayTile tile = tiler.make(begin, end - begin);
    const std::vector<KeyTriangle> part = triangles_of(tile.tin);
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// The one triangulation of all points, in memory.
inline Tin whole(const PointBuckets& buckets) {
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

inline void expect_one_triangulation(const PointBuckets& buckets, std::uint64_t tiles,
                                     std::size_t cache_bytes = std::size_t{16} << 20) {
  std::vector<KeyTriangle> expected = triangles_of(whole(buckets));
  std::vector<KeyTriangle> found = tiled(buckets, tiles, cache_bytes);
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  ASSERT_EQ(expected.size(), found.size()) << tiles << " tiles";
  ASSERT_TRUE(expected == found) << tiles << " tiles";
}

}  // namespace ptin
