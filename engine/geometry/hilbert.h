// SPDX-License-Identifier: GPL-3.0-or-later
//
// Position along the Hilbert curve: points that are near along the curve are near in the plane.
#pragma once

#include <bit>
#include <cstdint>

namespace ptin {

/// Position of the cell (x, y) along the Hilbert curve of order 32. A bijection from pairs of
/// 32-bit numbers to 64-bit ones; consecutive positions are cells that share a side. (0, 0) has
/// position 0.
[[nodiscard]] constexpr std::uint64_t hilbert_position(std::uint32_t x, std::uint32_t y) noexcept {
  // One quadrant a step, from the largest: its place along the curve of four quadrants is appended,
  // and the frame is turned to the one in which the rest of the curve is the standard one.
  // `swapped` and `inverted` are all ones or zeros, so that the loop has no branch. Quadrants that
  // both numbers are too small for only exchange the axes, each once.
  const int passed = std::countl_zero(x | y);
  std::uint64_t position = 0;
  std::uint32_t swapped = 0U - (static_cast<std::uint32_t>(passed) & 1U);
  std::uint32_t inverted = 0;
  for (int bit = 31 - passed; bit >= 0; --bit) {
    const std::uint32_t exchanged = (x ^ y) & swapped;
    const std::uint32_t qx = (((x ^ exchanged) ^ inverted) >> bit) & 1U;
    const std::uint32_t qy = (((y ^ exchanged) ^ inverted) >> bit) & 1U;
    position = (position << 2) | ((3U * qx) ^ qy);
    // In the lower quadrants (qy == 0) the axes are exchanged; in the lower right one they are
    // mirrored too.
    const std::uint32_t lower = qy - 1U;
    swapped ^= lower;
    inverted ^= lower & (0U - qx);
  }
  return position;
}

/// A cell of the grid of the curve.
struct HilbertCell {
  std::uint32_t x = 0, y = 0;
  friend bool operator==(const HilbertCell&, const HilbertCell&) = default;
};

/// The cell at a position: the inverse of hilbert_position().
[[nodiscard]] constexpr HilbertCell hilbert_cell(std::uint64_t position) noexcept {
  HilbertCell cell;
  const int passed = std::countl_zero(position) / 2;
  std::uint32_t swapped = 0U - (static_cast<std::uint32_t>(passed) & 1U);
  std::uint32_t inverted = 0;
  for (int bit = 31 - passed; bit >= 0; --bit) {
    const auto place = static_cast<std::uint32_t>(position >> (2 * bit)) & 3U;
    const std::uint32_t qx = place >> 1;
    const std::uint32_t qy = (place ^ qx) & 1U;
    const std::uint32_t turned_x = (qx ^ inverted) & 1U;
    const std::uint32_t turned_y = (qy ^ inverted) & 1U;
    const std::uint32_t exchanged = (turned_x ^ turned_y) & swapped;
    cell.x |= (turned_x ^ exchanged) << bit;
    cell.y |= (turned_y ^ exchanged) << bit;
    const std::uint32_t lower = qy - 1U;
    swapped ^= lower;
    inverted ^= lower & (0U - qx);
  }
  return cell;
}

}  // namespace ptin
