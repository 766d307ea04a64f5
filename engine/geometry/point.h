// SPDX-License-Identifier: GPL-3.0-or-later
//
// A position on the planar grid, and the 64-bit key that stands for a vertex.
#pragma once

#include <bit>
#include <compare>
#include <cstdint>

namespace ptin {

/// Largest coordinate of the grid. Chosen so that orient() is exact in 64 bits (orient.h).
inline constexpr std::int32_t kGridMax = std::int32_t{1} << 30;

/// A position on the planar grid: 0 <= x, y <= kGridMax, x to the east, y to the north (grid
/// units).
struct GridPoint {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

/// The key of a vertex is its grid position, ordered by y, then x. Vertices have no numbers on
/// which tiles, threads and machines would have to agree.
using VertexKey = std::uint64_t;

/// A key that no vertex has.
inline constexpr VertexKey kNoVertexKey = ~VertexKey{0};

[[nodiscard]] constexpr VertexKey key_of(GridPoint p) noexcept {
  if constexpr (std::endian::native == std::endian::little) {
    return std::bit_cast<VertexKey>(p);  // one load
  }
  return (static_cast<VertexKey>(static_cast<std::uint32_t>(p.y)) << 32) |
         static_cast<std::uint32_t>(p.x);
}

[[nodiscard]] constexpr GridPoint point_of(VertexKey key) noexcept {
  return {static_cast<std::int32_t>(static_cast<std::uint32_t>(key)),
          static_cast<std::int32_t>(key >> 32)};
}

/// True when both coordinates lie on the grid.
[[nodiscard]] constexpr bool on_grid(GridPoint p) noexcept {
  return p.x >= 0 && p.y >= 0 && p.x <= kGridMax && p.y <= kGridMax;
}

}  // namespace ptin
