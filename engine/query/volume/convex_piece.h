// SPDX-License-Identifier: GPL-3.0-or-later
//
// Convex polygons of a few corners, cut by half-planes (Sutherland and Hodgman, 1974).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "engine/geometry/affine.h"
#include "engine/query/shape/clip.h"

namespace ptin {

/// A convex polygon, counter-clockwise, on the grid. Positions are doubles in grid units. It has
/// room for a triangle that is cut by a triangle and by a quadrilateral; each cut adds at most one
/// corner. Rounding moves a cut across the line by a few units in the last place of the coordinates,
/// and never a corner that the cut leaves alone.
class ConvexPiece {
 public:
  ConvexPiece() = default;
  ConvexPiece(MapPoint a, MapPoint b, MapPoint c) : corners_{a, b, c}, size_(3) {}
  ConvexPiece(MapPoint a, MapPoint b, MapPoint c, MapPoint d) : corners_{a, b, c, d}, size_(4) {}

  /// Keeps what lies on the left of the line from a to b, or on it.
  void keep_left(MapPoint a, MapPoint b) {
    std::array<double, kMost> side{};
    bool is_whole = true;
    for (std::size_t i = 0; i < size_; ++i) {
      side[i] = cross(a, b, corners_[i]);
      is_whole = is_whole && side[i] >= 0;
    }
    if (!is_whole) cut(side);
  }
  /// Keeps what lies in another piece too.
  void keep_in(const ConvexPiece& other) {
    for (std::size_t i = 0; i < other.size_ && size_ >= 3; ++i) {
      keep_left(other.corners_[i], other.corners_[(i + 1) % other.size_]);
    }
  }

  [[nodiscard]] std::span<const MapPoint> corners() const { return {corners_.data(), size_}; }
  [[nodiscard]] bool is_empty() const { return size_ < 3; }
  /// Area of the triangle of corners 0, i and i + 1, square grid units; not negative.
  [[nodiscard]] double fan_area(std::size_t i) const {
    return std::fmax(0.0, cross(corners_[0], corners_[i], corners_[i + 1]) / 2);
  }

 private:
  static constexpr std::size_t kMost = 12;

  void cut(const std::array<double, kMost>& side) {
    std::array<MapPoint, kMost> kept;
    std::size_t n = 0;
    const auto put = [&](MapPoint p) {
      if (n < kMost) kept[n++] = p;
    };
    clip_convex(
        size_, [&](std::size_t i) { return side[i]; }, [&](std::size_t i) { put(corners_[i]); },
        [&](std::size_t i, std::size_t j) { put(crossing(i, j, side[i], side[j])); });
    corners_ = kept;
    size_ = n < 3 ? 0 : n;
  }
  /// Computed from the end on the left, so that the two pieces of one edge meet in the same bits.
  [[nodiscard]] MapPoint crossing(std::size_t i, std::size_t j, double at_i, double at_j) const {
    const MapPoint p = corners_[at_i > 0 ? i : j], q = corners_[at_i > 0 ? j : i];
    const double of_p = at_i > 0 ? at_i : at_j, of_q = at_i > 0 ? at_j : at_i;
    const double t = of_p / (of_p - of_q);
    return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
  }

  std::array<MapPoint, kMost> corners_{};
  std::size_t size_ = 0;
};

}  // namespace ptin
