// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/line_oracle.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace ptin::reference {

Rational cross(const RationalPoint& a, const RationalPoint& b, const RationalPoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

namespace {

std::array<RationalPoint, 3> corners(const Tin& tin, TriangleId t) {
  const Triangle& triangle = tin.triangles[t];
  return {rational_of(tin.position(triangle.v[0])), rational_of(tin.position(triangle.v[1])),
          rational_of(tin.position(triangle.v[2]))};
}

}  // namespace

namespace {

/// Surely apart, by boxes that are a grid unit too large: rationals are slow.
bool is_far(const Tin& tin, TriangleId t, const RationalPoint& p, const RationalPoint& q) {
  const auto apart = [](double a0, double a1, double b0, double b1, double b2) {
    return std::max({b0, b1, b2}) < std::min(a0, a1) - 1 ||
           std::min({b0, b1, b2}) > std::max(a0, a1) + 1;
  };
  const GridPoint a = tin.position(tin.triangles[t].v[0]);
  const GridPoint b = tin.position(tin.triangles[t].v[1]);
  const GridPoint c = tin.position(tin.triangles[t].v[2]);
  return apart(p.x.convert_to<double>(), q.x.convert_to<double>(), a.x, b.x, c.x) ||
         apart(p.y.convert_to<double>(), q.y.convert_to<double>(), a.y, b.y, c.y);
}

}  // namespace

Rational rational_of(Int128 v) {
  // In three digits of 2^42, each of which a 64-bit integer holds.
  constexpr std::int64_t kDigit = std::int64_t{1} << 42;
  Rational sum = static_cast<std::int64_t>(v / kDigit / kDigit);
  sum = sum * kDigit + static_cast<std::int64_t>(v / kDigit % kDigit);
  return sum * kDigit + static_cast<std::int64_t>(v % kDigit);
}

RationalPoint rational_of(Spot s) {
  const Rational unit = Rational(1) / (std::int64_t{1} << kSpotBits);
  return {Rational(s.x) * unit, Rational(s.y) * unit};
}

RationalPoint rational_of(GridPoint p) { return {Rational(p.x), Rational(p.y)}; }

std::vector<TriangleId> triangles_at(const Tin& tin, const RationalPoint& p) {
  std::vector<TriangleId> all;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (is_far(tin, t, p, p)) {
      continue;
    }
    const auto c = corners(tin, t);
    if (cross(c[0], c[1], p) >= 0 && cross(c[1], c[2], p) >= 0 && cross(c[2], c[0], p) >= 0) {
      all.push_back(t);
    }
  }
  return all;
}

TriangleId answering_among(const Tin& tin, const std::vector<TriangleId>& at) {
  const auto rank = [&](TriangleId t) {
    std::array<VertexKey, 3> keys{};
    for (std::size_t i = 0; i < 3; ++i) keys[i] = key_of(tin.position(tin.triangles[t].v[i]));
    std::sort(keys.begin(), keys.end());
    return std::pair(tin.classes[t], keys);
  };
  return *std::min_element(at.begin(), at.end(),
                           [&](TriangleId a, TriangleId b) { return rank(a) < rank(b); });
}

Rational code_on(const Tin& tin, const HeightEncoding& heights, TriangleId t,
                 const RationalPoint& p) {
  const auto c = corners(tin, t);
  Rational sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += cross(c[(i + 1) % 3], c[(i + 2) % 3], p) *
           Rational(heights.code(tin.vertices[tin.triangles[t].v[i]].height));
  }
  return sum / cross(c[0], c[1], c[2]);
}

/// Cuts the way by the three half-planes.
std::optional<Shares> shares_in(const Tin& tin, TriangleId t, const RationalPoint& p,
                                const RationalPoint& q) {
  if (is_far(tin, t, p, q)) {
    return std::nullopt;
  }
  const auto c = corners(tin, t);
  Shares s{0, 1};
  for (std::size_t i = 0; i < 3; ++i) {
    const Rational at_p = cross(c[i], c[(i + 1) % 3], p);
    const Rational at_q = cross(c[i], c[(i + 1) % 3], q);
    if (at_p < 0 && at_q < 0) {
      return std::nullopt;
    }
    if (at_p < 0) {
      s.from = std::max(s.from, Rational(at_p / (at_p - at_q)));
    } else if (at_q < 0) {
      s.to = std::min(s.to, Rational(at_p / (at_p - at_q)));
    }
  }
  if (s.from > s.to) {
    return std::nullopt;
  }
  return s;
}

RationalPoint along(const RationalPoint& p, const RationalPoint& q, const Rational& share) {
  return {p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
}

std::set<Rational> stops(const Tin& tin, const RationalPoint& p, const RationalPoint& q) {
  std::set<Rational> all;
  Rational first = 2;
  Rational last = -1;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    const std::optional<Shares> s = shares_in(tin, t, p, q);
    if (!s) {
      continue;
    }
    // The ends of the part in a triangle are where the way crosses its border; a vertex that it
    // passes, and an edge that it follows, end the part too.
    all.insert(s->from);
    all.insert(s->to);
    first = std::min(first, s->from);
    last = std::max(last, s->to);
  }
  return all;
}

Spot nasty_spot(std::mt19937_64& random, const Tin& tin) {
  const auto vertex = [&] {
    return spot_of(tin.position(static_cast<VertexId>(random() % tin.vertices.size())));
  };
  const Spot a = vertex();
  const Triangle& t = tin.triangles[random() % tin.triangles.size()];
  const auto corner = [&](int i) { return spot_of(tin.position(t.v[i])); };
  const int i = static_cast<int>(random() % 3);
  const Spot e = corner(i);
  const Spot f = corner(next_corner(i));
  const auto offset = [&](std::int64_t reach) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * reach + 1)) - reach;
  };
  switch (random() % 8) {
    case 0:
    case 1:
      return a;
    case 2:  // in an edge
      return {(e.x + f.x) / 2, (e.y + f.y) / 2};
    case 3: {  // near an edge, by a hair
      const Spot g{(e.x + f.x) / 2, (e.y + f.y) / 2};
      return {g.x + offset(1), g.y + offset(1)};
    }
    case 4:  // on the line of an edge, often beyond the border
      return {f.x + 2 * (f.x - e.x), f.y + 2 * (f.y - e.y)};
    case 5: {  // on the line of the domain's border
      const Spot b = vertex();
      return {random() % 2 == 0 ? std::int64_t{0} : b.x, random() % 2 == 0 ? std::int64_t{0} : a.y};
    }
    default: {
      const Spot g = corner(previous_corner(i));
      return {(e.x + f.x + g.x) / 3 + offset(std::int64_t{3} << kSpotBits),
              (e.y + f.y + g.y) / 3 + offset(std::int64_t{3} << kSpotBits)};
    }
  }
}

}  // namespace ptin::reference
