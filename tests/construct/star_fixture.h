// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stars with samples in them, as they come up in the middle of a construction.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/tile.h"
#include "tests/construct/exact_oracle.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/test_terrain.h"

namespace ptin::oracle {

/// A number without a pattern, the same for the same position.
[[nodiscard]] inline std::uint32_t noise(GridPoint p) {
  auto h = static_cast<std::uint32_t>(p.x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(p.y);
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  return h ^ (h >> 13);
}

/// A Delaunay triangulation of scattered points, with removed samples at random places inside of
/// its triangles.
struct StarTile {
  Tile tile;

  /// @param extent  Side of the square, grid units, at `origin`.
  /// @param code    Height code at a position; called once a vertex and once a sample.
  StarTile(std::uint64_t seed, std::int32_t extent, GridPoint origin, const HeightEncoding& heights,
           const std::function<double(GridPoint)>& code, int vertices = 24, int samples = 60) {
    std::mt19937_64 random(seed);
    const auto place = [&] {
      return GridPoint{
          origin.x + static_cast<std::int32_t>(random() % (std::uint64_t(extent) + 1)),
          origin.y + static_cast<std::int32_t>(random() % (std::uint64_t(extent) + 1))};
    };
    std::vector<GridPoint> positions{origin,
                                     {origin.x + extent, origin.y},
                                     {origin.x + extent / 2, origin.y},
                                     {origin.x, origin.y + extent}};
    for (int i = 0; i < vertices; ++i) {
      positions.push_back(place());
    }
    tile = std::move(make_points({"star", positions, code, heights}).tile);
    std::vector<std::vector<Sample>> lists(tile.tin.triangles.size());
    for (int i = 0; i < samples; ++i) {
      const GridPoint p = place();
      for (TriangleId t = 0; t < lists.size(); ++t) {
        if (in_closed(corners_of(tile.tin, t, heights), p)) {
          lists[t].push_back({p, heights.bits(code(p)), std::numeric_limits<float>::infinity(), 0});
          break;
        }
      }
    }
    for (TriangleId t = 0; t < lists.size(); ++t) {
      tile.carried[t].samples = tile.samples.take(static_cast<std::uint32_t>(lists[t].size()));
      std::copy(lists[t].begin(), lists[t].end(),
                tile.samples.samples(tile.carried[t].samples).begin());
      tile.carried[t].holds_heights = !lists[t].empty();
    }
  }
};

/// The star of `u` with all its samples, flat or not.
inline void gather_all(const Tile& tile, VertexId u, StarSamples& s) {
  gather_star(tile, u, s);
  if (s.count == 0) {
    gather_samples(tile, s);
  }
  gather_sources(tile, s);
}

/// Fan triangle `i` as the oracle sees it.
[[nodiscard]] inline Corners fan_corners(const Tile& tile, const StarSamples& s,
                                         const FanFrame& fan, std::size_t i) {
  const std::size_t degree = s.star.degree();
  const auto corner = [&](std::size_t link) {
    const VertexId v = s.star.link[link % degree];
    return Corner{tile.tin.position(v), tile.units.heights.code(tile.tin.vertices[v].height)};
  };
  return {corner(fan.j), corner(fan.star_triangle[i]), corner(fan.star_triangle[i] + 1U)};
}

}  // namespace ptin::oracle
