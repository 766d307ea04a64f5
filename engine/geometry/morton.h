// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of a quadtree (Morton order).
#pragma once

#include <cstdint>

namespace ptin {

/// The bits of `v` with a zero after each.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint32_t v) noexcept {
  std::uint64_t x = v;
  x = (x | (x << 16)) & 0x0000ffff0000ffffU;
  x = (x | (x << 8)) & 0x00ff00ff00ff00ffU;
  x = (x | (x << 4)) & 0x0f0f0f0f0f0f0f0fU;
  x = (x | (x << 2)) & 0x3333333333333333U;
  return (x | (x << 1)) & 0x5555555555555555U;
}

/// Place of the cell (x, y) among all cells of its size, in the order of a quadtree: the four
/// quarters of a larger cell follow one another.
[[nodiscard]] constexpr std::uint64_t morton_position(std::uint32_t x, std::uint32_t y) noexcept {
  return spread_bits(x) | (spread_bits(y) << 1);
}

}  // namespace ptin
