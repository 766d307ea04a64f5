// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which triangles of a mesh share an edge, looked up by its middle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// Pairs the two triangles of each edge by the middle of the edge. In a mesh without cracks no two
/// edges have the same middle, and in half grid units its coordinates are whole: so the middle is a
/// place in an array.
class EdgeMiddles {
 public:
  /// @param box  Box of the mesh. Memory: 16 bytes for each grid point in it.
  explicit EdgeMiddles(const GridBox& box)
      : box_(box),
        width_(2 * steps(box.min_x, box.max_x) + 1),
        first_(width_ * (2 * steps(box.min_y, box.max_y) + 1), kNone) {}

  struct Side {
    TriangleId triangle = kNone;
    int side = 0;  ///< Opposite to this corner.
  };
  /// The side with the same ends that was given before. Where there is none, keeps `added` and
  /// returns a side of triangle kNone.
  Side match(const Tin& tin, const Side& added) {
    const Triangle& triangle = tin.triangles[added.triangle];
    const GridPoint p = tin.position(triangle.v[next_corner(added.side)]);
    const GridPoint q = tin.position(triangle.v[previous_corner(added.side)]);
    const std::size_t middle = (steps(box_.min_y, p.y) + steps(box_.min_y, q.y)) * width_ +
                               steps(box_.min_x, p.x) + steps(box_.min_x, q.x);
    std::uint32_t& first = first_[middle];
    if (first == kNone) {
      first = 3 * added.triangle + static_cast<std::uint32_t>(added.side);
      return {};
    }
    return {first / 3, static_cast<int>(first % 3)};
  }

 private:
  static std::size_t steps(std::int32_t from, std::int32_t to) noexcept {
    return static_cast<std::size_t>(to - from);
  }
  GridBox box_;
  std::size_t width_;
  std::vector<std::uint32_t> first_;  ///< By middle: 3 * triangle + side; kNone.
};

}  // namespace ptin
