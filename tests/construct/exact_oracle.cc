// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/exact_oracle.h"

#include <algorithm>
#include <cmath>

namespace ptin::oracle {

std::int64_t side(GridPoint a, GridPoint b, GridPoint p) {
  const std::int64_t ax = a.x - std::int64_t{p.x}, ay = a.y - std::int64_t{p.y};
  const std::int64_t bx = b.x - std::int64_t{p.x}, by = b.y - std::int64_t{p.y};
  return ax * by - bx * ay;
}

namespace {

std::int64_t least_side(const Corners& t, GridPoint p) {
  return std::min({side(t[0].position, t[1].position, p), side(t[1].position, t[2].position, p),
                   side(t[2].position, t[0].position, p)});
}

}  // namespace

bool in_closed(const Corners& t, GridPoint p) { return least_side(t, p) >= 0; }
bool in_open(const Corners& t, GridPoint p) { return least_side(t, p) > 0; }

Bound::Bound(double height, double step)
    : infinite_(std::isinf(height)),
      exact_(infinite_ ? Exact(0) : Exact(height) / Exact(step)),
      rough_(static_cast<long double>(height) / static_cast<long double>(step)) {}

long double Gap::Mean::rough() const {
  long double sum = 0.0L;
  long double weights = 0.0L;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += static_cast<long double>(weight[i]) * static_cast<long double>(code[i]);
    weights += static_cast<long double>(weight[i]);
  }
  return sum / weights;
}

Exact Gap::Mean::exact() const {
  Exact sum = 0;
  Exact weights = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += Exact(weight[i]) * Exact(code[i]);
    weights += Exact(weight[i]);
  }
  return sum / weights;
}

Gap::Gap(const Mean& first, const Mean& second)
    : first_(first), second_(second), rough_(std::abs(first.rough() - second.rough())), scale_(0) {
  for (const Mean* m : {&first_, &second_}) {
    for (const double c : m->code) {
      scale_ = std::max(scale_, std::abs(static_cast<long double>(c)));
    }
  }
}

bool Gap::exceeds(const Bound& bound) const {
  if (bound.is_infinite()) {
    return false;
  }
  const long double doubt = 1e-16L * (scale_ + bound.rough());
  if (std::abs(rough_ - bound.rough()) > doubt) {
    return rough_ > bound.rough();
  }
  return abs(first_.exact() - second_.exact()) > bound.exact();
}

Gap Gap::of_sample(const Corners& t, GridPoint p, double code) {
  Mean plane;
  for (std::size_t i = 0; i < 3; ++i) {
    plane.weight[i] = side(t[(i + 1) % 3].position, t[(i + 2) % 3].position, p);
    plane.code[i] = t[i].code;
  }
  return {plane, {{1, 0, 0}, {code, 0.0, 0.0}}};
}

std::optional<Gap> Gap::of_crossing(const Corner& a, const Corner& b, const Corner& p,
                                    const Corner& q) {
  const std::int64_t of_p = side(a.position, b.position, p.position);
  const std::int64_t of_q = side(a.position, b.position, q.position);
  const std::int64_t of_a = side(p.position, q.position, a.position);
  const std::int64_t of_b = side(p.position, q.position, b.position);
  const auto opposite = [](std::int64_t v, std::int64_t w) { return (v < 0) != (w < 0); };
  const auto at_vertex = [&](const Corner& v) -> std::optional<Gap> {
    const auto between = [](std::int32_t lo, std::int32_t v_at, std::int32_t hi) {
      return std::min(lo, hi) <= v_at && v_at <= std::max(lo, hi);
    };
    const GridPoint at = v.position;
    if (!between(a.position.x, at.x, b.position.x) || !between(a.position.y, at.y, b.position.y) ||
        at == a.position || at == b.position) {
      return std::nullopt;
    }
    const bool by_x = a.position.x != b.position.x;
    const std::int64_t from_a = by_x ? at.x - a.position.x : at.y - a.position.y;
    const std::int64_t to_b = by_x ? b.position.x - at.x : b.position.y - at.y;
    return Gap({{std::abs(to_b), std::abs(from_a), 0}, {a.code, b.code, 0.0}},
               {{1, 0, 0}, {v.code, 0.0, 0.0}});
  };
  if (of_p == 0) {
    return at_vertex(p);
  }
  if (of_q == 0) {
    return at_vertex(q);
  }
  if (of_a == 0 || of_b == 0 || !opposite(of_p, of_q) || !opposite(of_a, of_b)) {
    return std::nullopt;
  }
  return Gap({{std::abs(of_b), std::abs(of_a), 0}, {a.code, b.code, 0.0}},
             {{std::abs(of_q), std::abs(of_p), 0}, {p.code, q.code, 0.0}});
}

}  // namespace ptin::oracle
