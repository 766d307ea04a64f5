// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/stream/split_code.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <type_traits>

#include "engine/geometry/hilbert.h"
#include "engine/geometry/orient.h"
#include "storage/record.h"

namespace ptin {

namespace {

// Rounded down and up. REQUIRES: b > 0.
constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept {
  return a / b - (a % b < 0 ? 1 : 0);
}
constexpr std::int64_t ceil_div(std::int64_t a, std::int64_t b) noexcept {
  return a / b + (a % b > 0 ? 1 : 0);
}

bool is_void(const Tin& tin, TriangleId t) { return tin.classes[t] == TriangleClass::kVoid; }

}  // namespace

/// A height as a whole number that keeps the order of heights: an int32 as it is, a float32 by its
/// bits.
std::int64_t SplitCode::number_of(HeightBits bits) const noexcept {
  // The magnitude of a float grows with its lower 31 bits; below 0 they are turned, so that order
  // is kept. -0 becomes -1 and not 0, so that each height comes back bit by bit.
  const auto n = std::bit_cast<std::int32_t>(bits);
  return type_ == HeightType::int32 || n >= 0 ? n : n ^ INT32_MAX;
}

HeightBits SplitCode::bits_of(std::int64_t number) const noexcept {
  const auto n = static_cast<std::int32_t>(number);
  return std::bit_cast<HeightBits>(type_ == HeightType::int32 || n >= 0 ? n : n ^ INT32_MAX);
}

void SplitCode::read_star(const Tin& tin, VertexId w) {
  walk_star(tin, w, star_);
  start_ = 0;
  if (star_.closed) {
    start_ = static_cast<std::size_t>(std::min_element(star_.link.begin(), star_.link.end()) -
                                      star_.link.begin());
  }
}

std::size_t SplitCode::place(VertexId v) const noexcept {
  const auto at = static_cast<std::size_t>(std::find(star_.link.begin(), star_.link.end(), v) -
                                           star_.link.begin());
  if (at == star_.link.size()) {
    return at;
  }
  return at >= start_ ? at - start_ : at + star_.link.size() - start_;
}

VertexId SplitCode::corner(std::size_t k) const noexcept {
  return star_.link[(start_ + fan_first_ + k) % star_.link.size()];
}

TriangleId SplitCode::fan_triangle(std::size_t k) const noexcept {
  return star_.triangles[(start_ + fan_first_ + k) % star_.link.size()];
}

template <class Symbols>
const char* SplitCode::code(Symbols& symbols, const Tin& tin, LocalSplit& s) {
  const char* fault = code_fan(symbols, tin, s);
  if (fault != nullptr) {
    return fault;
  }
  outline_.clear();
  outline_.push_back(tin.position(s.w));
  for (std::size_t k = 0; k < fan_corners(); ++k) {
    outline_.push_back(tin.position(corner(k)));
  }
  fault = side_ == Side::kInner ? code_inner_position(symbols, tin, s)
                                : code_border_position(symbols, tin, s);
  fault = fault != nullptr ? fault : code_height(symbols, tin, s);
  if (fault == nullptr) {
    code_classes(symbols, tin, s);
  }
  return fault;
}

/// Codes the fan, the triangles around w that get u: the place of corner vl, and how many triangles
/// follow.
template <class Symbols>
const char* SplitCode::code_fan(Symbols& symbols, const Tin& tin, LocalSplit& s) {
  read_star(tin, s.w);
  const auto corners = static_cast<std::uint32_t>(star_.link.size());
  side_ = (s.flags & VertexSplit::kNoLeft) != 0
              ? Side::kNoLeft
              : ((s.flags & VertexSplit::kNoRight) != 0 ? Side::kNoRight : Side::kInner);
  // A decoder does not know the flags yet: what follows decides its side_ from the code.
  if constexpr (Symbols::kAreKnown) {
    fan_first_ = place(s.vl);
    const std::size_t last = place(s.vr);
    fan_size_ = star_.closed && last < fan_first_ ? last + corners - fan_first_ : last - fan_first_;
    const bool fits = fan_first_ < corners && last < corners && fan_size_ > 0 &&
                      fan_size_ < corners && (side_ == Side::kInner || !star_.closed) &&
                      (side_ != Side::kNoLeft || fan_first_ == 0) &&
                      (side_ != Side::kNoRight || last + 1 == corners);
    if (!fits) {
      return "does not find its fan";
    }
  }
  if (star_.closed) {
    side_ = Side::kInner;
  } else if (symbols.bit(kAtBorder, side_ != Side::kInner)) {
    side_ = symbols.bit(kNoLeftTriangle, side_ == Side::kNoLeft) ? Side::kNoLeft : Side::kNoRight;
  } else {
    side_ = Side::kInner;
  }
  if (side_ != Side::kInner) {
    // The fan begins or ends at the border edge that u divides, so its size says where it is.
    fan_size_ =
        1 + symbols.range(kBorderSize, corners - 2, static_cast<std::uint32_t>(fan_size_) - 1);
    fan_first_ = side_ == Side::kNoLeft ? 0 : corners - 1 - fan_size_;
  } else {
    // Only places behind which a triangle follows are offered, and only sizes that the link has: no
    // bits are lost on others, and a decoder cannot leave the star.
    const std::uint32_t most_first = star_.closed ? corners - 1 : corners - 2;
    fan_first_ = symbols.range(kFanFirst, most_first, static_cast<std::uint32_t>(fan_first_));
    const std::size_t most = star_.closed ? corners - 1 : corners - 1 - fan_first_;
    fan_size_ = 1 + symbols.range(kInnerSize, static_cast<std::uint32_t>(most) - 1,
                                  static_cast<std::uint32_t>(fan_size_) - 1);
  }
  s.vl = corner(0);
  s.vr = corner(fan_size_);
  constexpr std::uint16_t kSides = VertexSplit::kNoLeft | VertexSplit::kNoRight;
  s.flags = static_cast<std::uint16_t>(s.flags & ~kSides);
  s.flags |= side_ == Side::kNoLeft ? VertexSplit::kNoLeft : 0;
  s.flags |= side_ == Side::kNoRight ? VertexSplit::kNoRight : 0;
  return nullptr;
}

/// The y for which (x, y) lies strictly to the left of every edge of the outline: exactly those for
/// which all triangles of u are counter-clockwise. Products stay below 2^61 as in orient().
bool SplitCode::column(std::int64_t x, std::int64_t& low, std::int64_t& high) const noexcept {
  low = 0;
  high = kGridMax;
  for (std::size_t i = 0; i < outline_.size(); ++i) {
    const GridPoint p = outline_[i];
    const GridPoint q = outline_[i + 1 == outline_.size() ? 0 : i + 1];
    const std::int64_t dx = std::int64_t{q.x} - p.x;
    // Strictly left of p -> q is dx (y - p.y) > t. A division by dx < 0 turns the sign round. For
    // whole y it is floor + 1 upward and ceil - 1 downward; for dx = 0 there is no y in it.
    const std::int64_t t = (std::int64_t{q.y} - p.y) * (x - p.x);
    if (dx > 0) {
      low = std::max(low, p.y + floor_div(t, dx) + 1);
    } else if (dx < 0) {
      high = std::min(high, p.y + ceil_div(-t, -dx) - 1);
    } else if (t >= 0) {
      return false;
    }
  }
  return low <= high;
}

template <class Symbols>
const char* SplitCode::code_inner_position(Symbols& symbols, const Tin& /*tin*/, LocalSplit& s) {
  std::int32_t min_x = outline_[0].x;
  std::int32_t max_x = outline_[0].x;
  for (const GridPoint p : outline_) {
    min_x = std::min(min_x, p.x);
    max_x = std::max(max_x, p.x);
  }
  // u lies strictly within its star, so no place is in the outermost columns.
  if (max_x - min_x < 2) {
    return "has no place for its vertex";
  }
  if (Symbols::kAreKnown && (s.u.x <= min_x || s.u.x >= max_x)) {
    return "has its vertex outside of its star";
  }
  // A decoder does not know u: the offset means nothing then, and its coder does not look at it.
  const auto x_offset = static_cast<std::uint32_t>(s.u.x - min_x - 1);
  const auto most_x = static_cast<std::uint32_t>(max_x - min_x - 2);
  s.u.x = min_x + 1 + static_cast<std::int32_t>(symbols.range(kX, most_x, x_offset));
  std::int64_t low = 0;
  std::int64_t high = 0;
  if (!column(s.u.x, low, high)) {
    return "has no place for its vertex";
  }
  if (Symbols::kAreKnown && (s.u.y < low || s.u.y > high)) {
    return "has its vertex outside of its star";
  }
  const auto most_y = static_cast<std::uint32_t>(high - low);
  const auto y_offset = static_cast<std::uint32_t>(s.u.y - low);
  s.u.y = static_cast<std::int32_t>(low + symbols.range(kY, most_y, y_offset));
  return nullptr;
}

/// On the border u is one of the grid points between w and the end of the fan.
template <class Symbols>
const char* SplitCode::code_border_position(Symbols& symbols, const Tin& tin, LocalSplit& s) {
  const GridPoint w = tin.position(s.w);
  const GridPoint end = tin.position(side_ == Side::kNoLeft ? s.vl : s.vr);
  const std::int32_t dx = end.x - w.x;
  const std::int32_t dy = end.y - w.y;
  const std::int32_t steps = std::gcd(dx, dy);
  if (steps < 2) {
    return "has no place for its vertex";
  }
  std::int32_t step = 1;
  if constexpr (Symbols::kAreKnown) {
    // The division may round for a u beside the edge; comparing places finds that out.
    step = dx != 0 ? (s.u.x - w.x) / (dx / steps) : (s.u.y - w.y) / (dy / steps);
    const GridPoint there{w.x + step * (dx / steps), w.y + step * (dy / steps)};
    if (step < 1 || step >= steps || there != s.u) {
      return "has its vertex outside of its edge";
    }
  }
  step = 1 + static_cast<std::int32_t>(symbols.range(kAlong, static_cast<std::uint32_t>(steps - 2),
                                                     static_cast<std::uint32_t>(step - 1)));
  s.u = {w.x + step * (dx / steps), w.y + step * (dy / steps)};
  return nullptr;
}

/// The triangle of the fan that holds u.
std::size_t SplitCode::fan_triangle_of(const Tin& tin, GridPoint u) const noexcept {
  const GridPoint w = outline_[0];
  for (std::size_t k = 0; k < fan_size_; ++k) {
    if (orient(w, tin.position(corner(k)), u) >= 0 &&
        orient(w, tin.position(corner(k + 1)), u) <= 0) {
      return k;
    }
  }
  // Both sides must name the same triangle also where none holds u; any would do.
  return fan_size_ - 1;
}

/// The number expected for the height of u: that of the plane of fan triangle k at u, rounded to
/// nearest, halves up. Where not all corners have heights, that of the first corner that has one;
/// where none has, none is expected.
std::optional<std::int64_t> SplitCode::predicted(const Tin& tin, const LocalSplit& s,
                                                 std::size_t k) const {
  const VertexId v[3] = {s.w, corner(k), corner(k + 1)};
  __extension__ using Wide = __int128;  // weights below 2^61, heights below 2^32
  Wide sum = 0;
  Wide area = 0;
  bool all = true;
  for (int i = 0; i < 3; ++i) {
    all = all && tin.has_height[v[i]] != 0;
    const std::int64_t weight =
        orient(s.u, tin.position(v[next_corner(i)]), tin.position(v[previous_corner(i)]));
    sum += static_cast<Wide>(weight) * number_of(tin.vertices[v[i]].height);
    area += weight;
  }
  if (all && area > 0) {
    // floor(sum / area + 1/2) is rounding with halves up. Division cuts towards 0, so a negative
    // remainder takes one off. Where u is not in triangle k the plane may leave the range.
    const Wide twice = 2 * sum + area;
    const Wide divisor = 2 * area;
    const auto quotient = static_cast<std::int64_t>(twice / divisor);
    const std::int64_t rounded = quotient - (twice % divisor < 0 ? 1 : 0);
    return std::clamp<std::int64_t>(rounded, INT32_MIN, INT32_MAX);
  }
  for (const VertexId c : v) {
    if (tin.has_height[c] != 0) {
      return number_of(tin.vertices[c].height);
    }
  }
  return std::nullopt;
}

/// Length in bits of the range of the heights of w and the fan, which shows about how far off a
/// prediction may be; 33 where none has a height.
std::size_t SplitCode::roughness(const Tin& tin) const {
  std::int64_t low = INT64_MAX;
  std::int64_t high = INT64_MIN;
  const auto see = [&](VertexId v) {
    if (tin.has_height[v] != 0) {
      low = std::min(low, number_of(tin.vertices[v].height));
      high = std::max(high, number_of(tin.vertices[v].height));
    }
  };
  see(star_.center);
  for (std::size_t k = 0; k < fan_corners(); ++k) {
    see(corner(k));
  }
  // A range of 32-bit numbers takes at most 32 bits, so 33 is free for "none".
  return low > high
             ? 33
             : static_cast<std::size_t>(std::bit_width(static_cast<std::uint64_t>(high - low)));
}

template <class Symbols>
const char* SplitCode::code_height(Symbols& symbols, const Tin& tin, LocalSplit& s) {
  const std::size_t k = fan_triangle_of(tin, s.u);
  bool all_void = true;
  for (std::size_t i = 0; i < fan_size_; ++i) {
    all_void = all_void && is_void(tin, fan_triangle(i));
  }
  // A vertex without a height stands in void triangles only, so elsewhere no bit is spent on it.
  bool has_none = (s.flags & VertexSplit::kVertexVoid) != 0;
  if (!all_void) {
    if (Symbols::kAreKnown && has_none) {
      return "has no height and splits a surface";
    }
    has_none = false;
  } else {
    const std::size_t without = (tin.has_height[s.w] == 0 ? 1U : 0U) +
                                (tin.has_height[corner(k)] == 0 ? 1U : 0U) +
                                (tin.has_height[corner(k + 1)] == 0 ? 1U : 0U);
    has_none = symbols.bit(kNoHeight + without, has_none);
  }
  s.flags = static_cast<std::uint16_t>(has_none ? s.flags | VertexSplit::kVertexVoid
                                                : s.flags & ~VertexSplit::kVertexVoid);
  if (has_none) {
    s.height = 0;
    return nullptr;
  }
  const std::int64_t number =
      symbols.height(roughness(tin), predicted(tin, s, k), number_of(s.height));
  // A residual needs 33 bits, and a damaged code can have 40.
  if (number < INT32_MIN || number > INT32_MAX) {
    return "has a height beyond all numbers";
  }
  s.height = bits_of(number);
  // Magnitudes above that of infinity are NaN.
  if (type_ == HeightType::float32 && (s.height & 0x7FFFFFFFU) > 0x7F800000U) {
    return "has a height that is no number";
  }
  return nullptr;
}

/// Codes the classes of the new triangles. Only a triangle whose corners all have heights can be
/// surface.
template <class Symbols>
void SplitCode::code_classes(Symbols& symbols, const Tin& tin, LocalSplit& s) {
  const bool has_height = (s.flags & VertexSplit::kVertexVoid) == 0;
  // `beside` is the triangle of the fan beside the new one, `outer` the one across the new one's
  // other side.
  const auto code_one = [&](std::size_t line, TriangleId beside, TriangleId outer, VertexId end,
                            std::uint16_t flag) {
    bool is = (s.flags & flag) != 0;
    if (has_height && tin.has_height[s.w] != 0 && tin.has_height[end] != 0) {
      const bool outer_void = outer != kNone && is_void(tin, outer);
      is = symbols.bit(line + (is_void(tin, beside) ? 1U : 0U) + (outer_void ? 2U : 0U), is);
    } else {
      is = true;
    }
    s.flags = static_cast<std::uint16_t>(is ? s.flags | flag : s.flags & ~flag);
  };
  const TriangleId first = fan_triangle(0);
  const TriangleId last = fan_triangle(fan_size_ - 1);
  const auto across = [&](TriangleId t, int (*turn)(int)) {
    return tin.triangles[t].n[turn(corner_of(tin.triangles[t], s.w))];
  };
  constexpr std::uint16_t kClasses = VertexSplit::kLeftVoid | VertexSplit::kRightVoid;
  // A triangle that does not exist has no class: its flag stays clear on both sides.
  const std::uint16_t given = s.flags;
  s.flags = static_cast<std::uint16_t>(s.flags & ~kClasses);
  if (side_ != Side::kNoLeft) {
    s.flags |= given & VertexSplit::kLeftVoid;
    code_one(kLeftIsVoid, first, across(first, previous_corner), s.vl, VertexSplit::kLeftVoid);
  }
  if (side_ != Side::kNoRight) {
    s.flags |= given & VertexSplit::kRightVoid;
    code_one(kRightIsVoid, last, across(last, next_corner), s.vr, VertexSplit::kRightVoid);
  }
}

template const char* SplitCode::code(RecordedSymbols&, const Tin&, LocalSplit&);
template const char* SplitCode::code(DecodedSymbols&, const Tin&, LocalSplit&);

}  // namespace ptin
