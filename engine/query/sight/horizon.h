// SPDX-License-Identifier: GPL-3.0-or-later
//
// The horizon around an eye: for each direction the steepest of the edges seen so far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ptin {

/// A point relative to the eye. x and y have one unit; z may have another, the same for all points.
struct Offset {
  double x = 0, y = 0, z = 0;
};

/// Twice the signed area of the triangle (eye, a, b) in the plane.
[[nodiscard]] inline double turn(const Offset& a, const Offset& b) noexcept {
  return a.x * b.y - a.y * b.x;
}

/// The upper envelope of the edges raised so far, over the directions around the eye. An edge is
/// kept as the plane through the edge and the eye. In a direction the plane has a slope, which is
/// linear in the direction, so no angles are computed. Where offsets are integers of moderate size
/// (products of three below 2^53) no comparison rounds, except near the direction at which two
/// edges cross.
///
/// Edges must come front to back: a point that is asked for lies beyond all edges raised in its
/// direction. Directions are kept in buckets, each with its pieces in order; an edge near the eye
/// spans many buckets, one far away few.
/// Threads: one owner.
class Horizon {
 public:
  /// @param buckets  About four times the radius divided by the length of an edge; >= 4.
  explicit Horizon(std::size_t buckets);

  /// Which pieces count in a direction in which two pieces meet: both, or the one to its left or
  /// right.
  enum class Side : std::uint8_t { kBoth, kLeft, kRight };

  /// Raises the horizon to the edge a -> b. REQUIRES: turn(a, b) > 0.
  void raise(const Offset& a, const Offset& b);

  /// True when no edge raised so far rises strictly above the ray to `p`. REQUIRES: `p` is not
  /// above or below the eye itself. Cost: the pieces in the bucket.
  [[nodiscard]] bool sees(const Offset& p, Side side = Side::kBoth) const noexcept {
    return sees(p, side, p);
  }
  /// The same where `p` lies in the direction of `along` but for its rounding: the pieces are those that
  /// meet in that direction.
  [[nodiscard]] bool sees(const Offset& p, Side side, const Offset& along) const noexcept;

  [[nodiscard]] std::size_t pieces() const noexcept { return pieces_; }

 private:
  struct Direction {
    double x, y;
  };
  /// A plane through the eye with the normal n = (x, y, z): points with n . p >= 0 lie on it or
  /// above. z == 0: no edge yet.
  struct Plane {
    double x = 0, y = 0, z = 0;
    friend bool operator==(const Plane&, const Plane&) = default;
  };
  /// From `start` counter-clockwise to the next piece, or the end of its bucket.
  struct Piece {
    Direction start;
    Plane plane;
  };
  static double turn(Direction a, Direction b) noexcept { return a.x * b.y - a.y * b.x; }
  [[nodiscard]] std::size_t bucket_of(Direction d) const noexcept;
  [[nodiscard]] std::size_t after(std::size_t bucket) const noexcept {
    return bucket + 1 == buckets_.size() ? 0 : bucket + 1;
  }
  static bool hides(const Plane& plane, const Offset& p) noexcept {
    return plane.z > 0 && plane.x * p.x + plane.y * p.y + plane.z * p.z < 0;
  }
  void raise_in(std::size_t bucket, Direction from, Direction to, const Plane& plane);
  void add(Direction start, const Plane& plane);

  std::vector<Direction> borders_;  ///< Direction in which each bucket begins.
  std::vector<std::vector<Piece>> buckets_;
  std::vector<Piece> scratch_;
  std::size_t pieces_ = 0;
};

}  // namespace ptin
