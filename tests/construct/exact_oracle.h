// SPDX-License-Identifier: GPL-3.0-or-later
//
// Exact geometry for oracles: rationals where it is close, long doubles where it is not. Shares no
// code with the engine.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <boost/multiprecision/cpp_int.hpp>

#include "engine/geometry/point.h"

namespace ptin::oracle {

using Exact = boost::multiprecision::cpp_rational;

/// A vertex of a surface: position and height code.
struct Corner {
  GridPoint position;
  double code = 0.0;
};
using Corners = std::array<Corner, 3>;

/// Twice the signed area of (a, b, p): positive where p lies to the left of a -> b.
[[nodiscard]] std::int64_t side(GridPoint a, GridPoint b, GridPoint p);
[[nodiscard]] bool in_closed(const Corners& t, GridPoint p);
[[nodiscard]] bool in_open(const Corners& t, GridPoint p);

/// A bound on differences of codes, exact: `height` / `step`.
class Bound {
 public:
  Bound(double height, double step);
  [[nodiscard]] bool is_infinite() const { return infinite_; }
  [[nodiscard]] const Exact& exact() const { return exact_; }
  [[nodiscard]] long double rough() const { return rough_; }

 private:
  bool infinite_;
  Exact exact_;
  long double rough_;
};

/// A vertical distance: its rough value, and a comparison that is exact.
class Gap {
 public:
  /// Between the plane of `t` and the code at `p`.
  [[nodiscard]] static Gap of_sample(const Corners& t, GridPoint p, double code);
  /// Between the segments a-b and p-q where they meet; nothing where they do not, or only at ends
  /// of a-b. Where p (or q) lies on a-b it is the distance there.
  [[nodiscard]] static std::optional<Gap> of_crossing(const Corner& a, const Corner& b,
                                                      const Corner& p, const Corner& q);

  [[nodiscard]] long double rough() const { return rough_; }
  [[nodiscard]] bool exceeds(const Bound& bound) const;
  [[nodiscard]] bool is_zero() const { return !exceeds(Bound(0.0, 1.0)); }

 private:
  /// One surface at the point: (code_a * weight_b + code_b * weight_a) / (weight_a + weight_b), or
  /// the sum of three. Kept as given, so that exact arithmetic is done where it is needed alone.
  struct Mean {
    std::array<std::int64_t, 3> weight{};
    std::array<double, 3> code{};
    [[nodiscard]] long double rough() const;
    [[nodiscard]] Exact exact() const;
  };
  Gap(const Mean& first, const Mean& second);

  Mean first_, second_;
  long double rough_;
  long double scale_;
};

}  // namespace ptin::oracle
