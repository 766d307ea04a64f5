// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/living/triangle_on_line.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/query/living/spot_in_triangle.h"

namespace ptin {

namespace {

/// A line over one triangle.
class LineOverTriangle {
 public:
  LineOverTriangle(const LivingTriangle& t, const HeightEncoding& heights, Spot p, Spot q)
      : t_(t), heights_(heights), p_(p), q_(q) {
    for (std::size_t i = 0; i < 3; ++i) {
      turn_[i] = side(p, q, t.corner[i].position);
    }
  }
  [[nodiscard]] std::optional<SharedStretch> stretch() const;

 private:
  [[nodiscard]] LinePoint at_vertex(std::size_t i) const;
  [[nodiscard]] LinePoint at_edge(std::size_t i, std::size_t j) const;
  [[nodiscard]] LinePoint at_end(Spot end, int share) const;
  [[nodiscard]] std::optional<SharedStretch> within_ends(SharedStretch crossed) const;
  [[nodiscard]] double code(std::size_t i) const { return heights_.code(t_.corner[i].height); }

  const LivingTriangle& t_;
  const HeightEncoding& heights_;
  Spot p_, q_;
  std::array<Int128, 3> turn_;
};

/// Where the line through p and q has corner i, which may lie before p or beyond q.
LinePoint LineOverTriangle::at_vertex(std::size_t i) const {
  const Spot at = spot_of(t_.corner[i].position);
  const std::int64_t dx = q_.x - p_.x;
  const std::int64_t dy = q_.y - p_.y;
  const bool by_x = (dx < 0 ? -dx : dx) >= (dy < 0 ? -dy : dy);
  const std::int64_t whole = by_x ? dx : dy;
  const std::int64_t part = by_x ? at.x - p_.x : at.y - p_.y;
  LinePoint point{{1, {code(i)}, {1}}, part, whole};
  if (whole < 0) {
    point.numerator = -point.numerator;
    point.denominator = -point.denominator;
  }
  return point;
}

/// Where the line through p and q crosses the side from corner i to corner j, which lie on either
/// side of it.
LinePoint LineOverTriangle::at_edge(std::size_t i, std::size_t j) const {
  if (key_of(t_.corner[j].position) < key_of(t_.corner[i].position)) {
    std::swap(i, j);
  }
  const auto magnitude = [](Int128 v) { return v < 0 ? -v : v; };
  const GridPoint a = t_.corner[i].position;
  const GridPoint b = t_.corner[j].position;
  LinePoint point{{2, {code(i), code(j)}, {magnitude(turn_[j]), magnitude(turn_[i])}}, 0, 1};
  point.numerator = side(a, b, p_);
  point.denominator = point.numerator - side(a, b, q_);
  if (point.denominator < 0) {
    point.numerator = -point.numerator;
    point.denominator = -point.denominator;
  }
  return point;
}

LinePoint LineOverTriangle::at_end(Spot end, int share) const {
  return {codes_in(t_, heights_, end), share, 1};
}

/// Leaves out what lies before p or beyond q.
std::optional<SharedStretch> LineOverTriangle::within_ends(SharedStretch crossed) const {
  LinePoint& from = crossed.from;
  LinePoint& to = crossed.to;
  if (to.numerator < 0 || from.numerator > from.denominator) {
    return std::nullopt;
  }
  crossed.is_point = crossed.is_point || to.numerator == 0 || from.numerator == from.denominator;
  if (crossed.is_point) {
    (to.numerator == 0 ? from : to) = to.numerator == 0 ? to : from;
    return crossed;
  }
  if (from.numerator <= 0) {
    from = at_end(p_, 0);
  }
  if (to.numerator > to.denominator) {
    to = at_end(q_, 1);
  }
  return crossed;
}

std::optional<SharedStretch> LineOverTriangle::stretch() const {
  SharedStretch crossed;
  bool has_from = false;
  bool has_to = false;
  std::array<std::size_t, 3> on_line{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = i == 2 ? 0 : i + 1;
    if (turn_[i] == 0) {
      on_line[count++] = i;
    } else if (turn_[i] > 0 && turn_[j] < 0) {  // corners come counter-clockwise: the line enters
      crossed.from = at_edge(i, j);
      has_from = true;
    } else if (turn_[i] < 0 && turn_[j] > 0) {
      crossed.to = at_edge(i, j);
      has_to = true;
    }
  }
  if (count == 0) {
    return has_from ? within_ends(std::move(crossed)) : std::nullopt;
  }
  const LinePoint first = at_vertex(on_line[0]);
  if (count == 2) {
    const LinePoint second = at_vertex(on_line[1]);
    const bool is_ahead = first.numerator < second.numerator;
    crossed = {is_ahead ? first : second, is_ahead ? second : first, true, false};
  } else {
    crossed.is_point = !has_from && !has_to;
    crossed.from = has_from ? crossed.from : first;
    crossed.to = has_to ? crossed.to : first;
  }
  return within_ends(std::move(crossed));
}

}  // namespace

std::optional<SharedStretch> shared_stretch(const LivingTriangle& t, const HeightEncoding& heights,
                                            Spot p, Spot q) {
  return LineOverTriangle(t, heights, p, q).stretch();
}

}  // namespace ptin
