// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether corners around a vertex can be the ring of its star.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ptin {

/// A corner of a ring as pages have it, and its triangle with u and the next corner.
struct RelativeCorner {
  std::int64_t x = 0, y = 0;  ///< From u. Within 32 bits.
  std::int64_t height = 0;    ///< Above that of u, as ordered numbers; 0 where it has none.
  std::uint32_t death = 0;    ///< As stored_death(), of the triangle.
  bool is_void = false;       ///< The triangle.
  bool has_height = false;
};

/// Looks at the corners of a ring, one after the other: each two that follow one another make a
/// counter-clockwise triangle with u, a surface triangle has three heights, and all of them go
/// around u once. Exact.
class RingCheck {
 public:
  explicit RingCheck(bool u_has_height) noexcept : u_has_height_(u_has_height) {}

  void add(const RelativeCorner& c) noexcept {
    if (is_begun_) {
      add_triangle(last_, c);
    } else {
      first_ = c;
      is_begun_ = true;
    }
    last_ = c;
  }
  /// Whether the corners are the ring of a vertex inside of the domain. REQUIRES: some were added.
  [[nodiscard]] bool is_closed_ring() noexcept {
    add_triangle(last_, first_);
    return is_sound_ && rounds_ == 1;
  }
  /// Whether they are that of a vertex on the border. The domain is convex, so they go at most half
  /// around; behind the last one there is no triangle.
  [[nodiscard]] bool is_open_ring() const noexcept {
    return is_sound_ && rounds_ <= 1 && turn(first_, last_) >= 0 && !last_.is_void;
  }

 private:
  /// Twice the area of the triangle of u and two corners. A product that wraps around belongs to a
  /// corner off the grid.
  [[nodiscard]] static std::int64_t turn(const RelativeCorner& a,
                                         const RelativeCorner& b) noexcept {
    const auto wrapping = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
    return static_cast<std::int64_t>(wrapping(a.x) * wrapping(b.y) - wrapping(a.y) * wrapping(b.x));
  }
  /// Whether the angle of a corner is a half turn or more, from the direction of x on.
  [[nodiscard]] static bool is_in_lower_half(const RelativeCorner& c) noexcept {
    return (c.y < 0) | ((c.y == 0) & (c.x < 0));
  }
  void add_triangle(const RelativeCorner& a, const RelativeCorner& b) noexcept {
    is_sound_ &= (turn(a, b) > 0) & ((u_has_height_ & a.has_height & b.has_height) | a.is_void);
    rounds_ += static_cast<unsigned>(is_in_lower_half(a) & !is_in_lower_half(b));
  }

  bool u_has_height_;
  bool is_begun_ = false;
  bool is_sound_ = true;
  unsigned rounds_ = 0;
  RelativeCorner first_, last_;
};

}  // namespace ptin
