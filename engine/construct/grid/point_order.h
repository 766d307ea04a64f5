// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order of points along the Hilbert curve over their own extent, and back.
#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/geometry/hilbert.h"
#include "engine/geometry/point.h"

namespace ptin {

/// The curve over the square at the origin that just holds all points: coordinates are stretched to
/// 32 bits, by the same factor in x and y, so that the curve's quarters are those of the terrain.
///
/// Let W be the side of the square in points, m = floor((2^32 - 1) 2^30 / W) the factor, and
/// X = floor(x m / 2^30) the stretched coordinate. W is at most 2^30 + 1, so m is at least 2^30:
/// each x has an X of its own, and x = ceil(X 2^30 / m). 64 bits hold the products, since
/// x m < W m < 2^62.
class PointOrder {
 public:
  /// @param largest  The largest x or y of all points, in grid units.
  explicit PointOrder(std::int64_t largest)
      : factor_((((std::uint64_t{1} << 32) - 1) << 30) / static_cast<std::uint64_t>(largest + 1)) {}

  /// The place of `p` along the curve.
  [[nodiscard]] std::uint64_t key(GridPoint p) const noexcept {
    return hilbert_position(stretched(p.x), stretched(p.y));
  }
  /// The point at a place that key() gave.
  [[nodiscard]] GridPoint point(std::uint64_t key) const noexcept {
    const HilbertCell cell = hilbert_cell(key);
    return {back(cell.x), back(cell.y)};
  }

 private:
  [[nodiscard]] std::uint32_t stretched(std::int32_t v) const noexcept {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(v) * factor_) >> 30);
  }
  [[nodiscard]] std::int32_t back(std::uint32_t v) const noexcept {
    return static_cast<std::int32_t>(((std::uint64_t{v} << 30) + factor_ - 1) / factor_);
  }
  std::uint64_t factor_;
};

}  // namespace ptin
