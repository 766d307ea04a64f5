// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a globe is divided into tiles, and the lattice of a level on which all its tiles have their
// vertices.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/tiles/globe.h"

namespace ptin::tools {

/// Steps of the lattice along a side of a tile.
inline constexpr std::int64_t kTileSteps = 32767;

/// A position on the lattice of a level: steps from the grid's south-western corner.
struct TilePoint {
  std::int64_t u = 0;  ///< To the east.
  std::int64_t v = 0;  ///< To the north.
  friend bool operator==(const TilePoint&, const TilePoint&) = default;
};

/// A closed box on the lattice of a level.
struct TileBox {
  std::int64_t min_u = INT64_MAX;
  std::int64_t min_v = INT64_MAX;
  std::int64_t max_u = INT64_MIN;
  std::int64_t max_v = INT64_MIN;

  void add(const TilePoint& p) noexcept {
    min_u = std::min(min_u, p.u);
    min_v = std::min(min_v, p.v);
    max_u = std::max(max_u, p.u);
    max_v = std::max(max_v, p.v);
  }
  [[nodiscard]] bool meets(const TileBox& b) const noexcept {
    return min_u <= b.max_u && b.min_u <= max_u && min_v <= b.max_v && b.min_v <= max_v;
  }
  [[nodiscard]] bool contains(const TileBox& b) const noexcept {
    return min_u <= b.min_u && min_v <= b.min_v && b.max_u <= max_u && b.max_v <= max_v;
  }
  [[nodiscard]] TileBox widened(std::int64_t by_u, std::int64_t by_v) const noexcept {
    return {min_u - by_u, min_v - by_v, max_u + by_u, max_v + by_v};
  }
};

/// A tile: x counts to the east, y to the north.
struct TileId {
  int level = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend bool operator==(const TileId&, const TileId&) = default;
};

/// Tiles of level 0 side by side, each with four children a level further, all in degrees.
struct TileGrid {
  double west = -180.0;
  double south = -90.0;
  double width = 180.0;  ///< Width of a tile of level 0.
  double height = 180.0;
  std::int64_t columns = 2;  ///< Columns of level 0.
  std::int64_t rows = 1;
  bool goes_around = true;  ///< The last column's neighbour is the first.

  [[nodiscard]] static TileBox box_of(const TileId& t) noexcept {
    return {t.x * kTileSteps, t.y * kTileSteps, (t.x + 1) * kTileSteps, (t.y + 1) * kTileSteps};
  }
  /// The nearest lattice point. Points of every tile of the level are rounded in the same way.
  [[nodiscard]] TilePoint lattice_point(int level, double lon, double lat) const noexcept {
    const double steps = std::ldexp(static_cast<double>(kTileSteps), level);
    return {std::llround((lon - west) / width * steps),
            std::llround((lat - south) / height * steps)};
  }
  [[nodiscard]] GlobePoint globe_point(int level, const TilePoint& p,
                                       double metres) const noexcept {
    const double steps = std::ldexp(static_cast<double>(kTileSteps), level);
    return {west + static_cast<double>(p.u) / steps * width,
            south + static_cast<double>(p.v) / steps * height, metres};
  }
  [[nodiscard]] GlobeBox globe_box(int level, const TileBox& b) const noexcept {
    const GlobePoint low = globe_point(level, {b.min_u, b.min_v}, 0.0);
    const GlobePoint high = globe_point(level, {b.max_u, b.max_v}, 0.0);
    return {low.lon, low.lat, high.lon, high.lat};
  }
};

}  // namespace ptin::tools
