// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_ray.h"

#include <algorithm>
#include <cstdint>

#include <boost/multiprecision/cpp_int.hpp>

namespace ptin {

namespace {

using Rational = boost::multiprecision::cpp_rational;

Rational rational(Int128 v) {
  constexpr std::int64_t kDigit = std::int64_t{1} << 42;
  Rational sum = static_cast<std::int64_t>(v / kDigit / kDigit);
  sum = sum * kDigit + static_cast<std::int64_t>(v / kDigit % kDigit);
  return sum * kDigit + static_cast<std::int64_t>(v % kDigit);
}

Rational share_of(const LinePoint& p) { return rational(p.numerator) / rational(p.denominator); }

Rational ground_at(const HeightEncoding& heights, const WeightedCodes& codes) {
  Rational sum = 0;
  Rational whole = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(codes.count); ++i) {
    const Rational weight = rational(codes.weight[i]);
    sum += weight * Rational(codes.code[i]);
    whole += weight;
  }
  return Rational(heights.offset) + Rational(heights.step) * sum / whole;
}

Rational height_of(const HeightEncoding& heights, const ExactEnd& end) {
  const Rational above(end.height);
  return end.ground == nullptr ? above : above + ground_at(heights, *end.ground);
}

Rational clearance_at(const HeightEncoding& heights, const LinePoint& p, const ExactEnd& a,
                      const ExactEnd& b, double bend) {
  const Rational s = share_of(p);
  const Rational line =
      height_of(heights, a) * (1 - s) + height_of(heights, b) * s - Rational(bend) * s * (1 - s);
  return line - ground_at(heights, p.ground);
}

}  // namespace

int ExactRay::sign_at(const LinePoint& at) const {
  return clearance_at(heights_, at, a_, b_, bend_).sign();
}

int ExactRay::sign_over(const LinePoint& from, const LinePoint& to) const {
  const Rational s0 = share_of(from);
  const Rational s1 = share_of(to);
  const Rational c0 = clearance_at(heights_, from, a_, b_, bend_);
  const Rational c1 = clearance_at(heights_, to, a_, b_, bend_);
  const int ends = std::min(c0.sign(), c1.sign());
  if (!(bend_ > 0) || ends < 0) {
    return ends;
  }
  const Rational bend(bend_);
  const Rational at = (s0 + s1) / 2 - (c1 - c0) / (2 * bend * (s1 - s0));
  if (!(at > s0 && at < s1)) {
    return ends;
  }
  return std::min(ends, Rational(c0 - bend * (at - s0) * (at - s0)).sign());
}

}  // namespace ptin
