// SPDX-License-Identifier: GPL-3.0-or-later
//
// Spots: positions between grid points, in fixed point. Every decision about a spot is exact.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/point.h"

namespace ptin {

__extension__ using Int128 = __int128;

/// A spot is a grid position in units of 2^-22 of a grid unit.
inline constexpr int kSpotBits = 22;
/// Largest coordinate of a spot, in its units: 2^31 grid units, twice the side of the largest grid.
inline constexpr std::int64_t kSpotMax = std::int64_t{1} << (31 + kSpotBits);

/// A position in the plane. SpotMap::spot() gives ones of at most kSpotMax along x and y.
struct Spot {
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend bool operator==(const Spot&, const Spot&) = default;
};

[[nodiscard]] constexpr Spot spot_of(GridPoint p) noexcept {
  return {std::int64_t{p.x} << kSpotBits, std::int64_t{p.y} << kSpotBits};
}
/// The grid coordinates of a spot. Exact, since a spot's coordinates are at most 2^53.
[[nodiscard]] constexpr MapPoint grid_of(Spot s) noexcept {
  constexpr double kUnit = 1.0 / (std::int64_t{1} << kSpotBits);
  return {static_cast<double>(s.x) * kUnit, static_cast<double>(s.y) * kUnit};
}

/// True when the closed box (grid units) holds the spot. Exact.
[[nodiscard]] constexpr bool contains(const GridBox& b, Spot s) noexcept {
  const Spot low = spot_of(GridPoint{b.min_x, b.min_y});
  const Spot high = spot_of(GridPoint{b.max_x, b.max_y});
  return low.x <= s.x && s.x <= high.x && low.y <= s.y && s.y <= high.y;
}

/// The smallest grid box that holds the spot. REQUIRES: it lies on the grid.
[[nodiscard]] constexpr GridBox box_around(Spot s) noexcept {
  const auto below = [](std::int64_t v) { return static_cast<std::int32_t>(v >> kSpotBits); };
  const auto above = [](std::int64_t v) { return static_cast<std::int32_t>(-(-v >> kSpotBits)); };
  return {below(s.x), below(s.y), above(s.x), above(s.y)};
}

/// Twice the signed area of (a, b, q), in units of 2^-22 of a grid unit squared: > 0 where q lies
/// to the left of a -> b. Exact: differences of at most 2^30 and 2^54, products below 2^85.
[[nodiscard]] constexpr Int128 side(GridPoint a, GridPoint b, Spot q) noexcept {
  const Spot from = spot_of(a);
  return Int128{std::int64_t{b.x} - a.x} * (q.y - from.y) -
         Int128{std::int64_t{b.y} - a.y} * (q.x - from.x);
}

/// True when the closed triangle (a, b, c), counter-clockwise, holds the spot. Exact.
[[nodiscard]] constexpr bool triangle_holds(GridPoint a, GridPoint b, GridPoint c,
                                            Spot q) noexcept {
  return side(a, b, q) >= 0 && side(b, c, q) >= 0 && side(c, a, q) >= 0;
}

/// The shares of a and b in a spot of the segment between them, as whole numbers: its distances from
/// b and from a along the axis along which they are farther apart. Areas give the same shares from
/// both sides of an edge, but in numbers so large that doubles round them differently.
[[nodiscard]] constexpr std::array<Int128, 2> edge_weights(GridPoint a, GridPoint b,
                                                           Spot q) noexcept {
  const Spot from = spot_of(a);
  const Spot to = spot_of(b);
  const auto apart = [](std::int64_t v, std::int64_t w) { return v < w ? w - v : v - w; };
  if (apart(from.x, to.x) >= apart(from.y, to.y)) return {apart(q.x, to.x), apart(q.x, from.x)};
  return {apart(q.y, to.y), apart(q.y, from.y)};
}

/// Twice the signed area of (a, b, c), in units of 2^-44: > 0 where c lies to the left of a -> b.
/// Exact for coordinates up to 2^60: differences below 2^61, products below 2^122.
[[nodiscard]] constexpr Int128 side(Spot a, Spot b, Spot c) noexcept {
  return Int128{b.x - a.x} * (c.y - a.y) - Int128{b.y - a.y} * (c.x - a.x);
}
[[nodiscard]] constexpr Int128 side(Spot a, Spot b, GridPoint c) noexcept {
  return side(a, b, spot_of(c));
}

/// True unless all corners of the box (grid units) lie strictly on one side of the line through p
/// and q. Exact.
[[nodiscard]] constexpr bool line_meets(Spot p, Spot q, const GridBox& b) noexcept {
  // The corners farthest to the left and to the right of the direction of the line.
  const bool east = q.x >= p.x;
  const bool north = q.y >= p.y;
  const GridPoint left{north ? b.min_x : b.max_x, east ? b.max_y : b.min_y};
  const GridPoint right{north ? b.max_x : b.min_x, east ? b.min_y : b.max_y};
  return side(p, q, left) >= 0 && side(p, q, right) <= 0;
}

/// The map from positions in map units to spots.
///
/// The grid position of a map position is (X - origin) / step in doubles, rounded to the nearest
/// multiple of 2^-bits(). Every question is asked of this rounded position, and nothing is rounded
/// after it.
///
/// bits() is 22, or fewer where doubles are too coarse for 22: the error of the conversion stays
/// below half a multiple everywhere in the domain. So the map position of a vertex becomes exactly
/// that vertex, and the height at a sample is the sample's.
class SpotMap {
 public:
  /// @param bounds  Box of the domain, grid units.
  SpotMap(const AffineMap& map, const GridBox& bounds);

  [[nodiscard]] int bits() const noexcept { return bits_; }
  /// The spot of a map position; nothing when the position lies more than 2^31 grid units away from
  /// the grid's origin, where no terrain is.
  /// @throws Error invalid_argument when a coordinate is not finite
  [[nodiscard]] std::optional<Spot> spot(MapPoint p) const;
  /// The spot nearest to a position in grid units. REQUIRES: coordinates of at most 2^38.
  [[nodiscard]] Spot rounded(MapPoint grid) const noexcept;
  [[nodiscard]] MapPoint map(Spot s) const noexcept {
    const MapPoint g = grid_of(s);
    return map_.to_map(g.x, g.y);
  }

 private:
  AffineMap map_;
  int bits_ = kSpotBits;
};

}  // namespace ptin
