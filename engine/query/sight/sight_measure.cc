// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/geometry/infinity.h"

namespace ptin {

namespace {

/// c(s) = constant + slope s + bend s^2.
struct Parabola {
  double constant, slope, bend;
  [[nodiscard]] double at(double s) const { return constant + s * (slope + s * bend); }
};

Parabola through(double from, double c_from, double to, double c_to, double bend) {
  const double slope = (c_to - c_from) / (to - from) - bend * (from + to);
  return {c_from - from * (slope + from * bend), slope, bend};
}

/// Numerator of the derivative of c(s) / sqrt(s (1 - s)), which has its sign for 0 < s < 1:
/// c'(s) s (1 - s) - c(s) (1 - 2 s) / 2.
double slope_sign(const Parabola& c, double s) {
  return (c.slope + 2 * c.bend * s) * s * (1 - s) - c.at(s) * (1 - 2 * s) / 2;
}

/// A change of sign between two shares, by halving.
double sign_change(const Parabola& c, double low, double high) {
  const bool rising = slope_sign(c, low) < 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    ((slope_sign(c, middle) < 0) == rising ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Where clearance(s) / sqrt(s (1 - s)) is least for shares s of the way in [from, to]. The
/// clearance is the convex parabola that has the values `c_from` and `c_to` at the ends and the
/// leading coefficient `bend`. The ends of the whole line (shares 0 and 1) are left out, since the
/// zone has no width there. REQUIRES: from < to.
struct LeastRatio {
  double ratio;  ///< Infinite when [from, to] has no inner point of the line.
  double at;     ///< Share of the way.
};
LeastRatio least_fresnel_ratio(double from, double c_from, double to, double c_to, double bend) {
  LeastRatio least{kInfinity, from};
  const Parabola c = through(from, c_from, to, c_to, bend);
  const auto consider = [&](double s) {
    if (s > 0 && s < 1) {
      const double ratio = c.at(s) / std::sqrt(s * (1 - s));
      if (ratio < least.ratio) {
        least = {ratio, s};
      }
    }
  };
  // The numerator is a cubic, -bend s^3 + 3/2 bend s^2 + (constant + slope / 2) s - constant / 2:
  // it is monotone between the roots of its derivative.
  std::array<double, 4> cuts{from, from, to, to};
  if (bend != 0) {
    const double inside = 0.25 + (c.constant + c.slope / 2) / (3 * bend);
    if (inside > 0) {
      cuts[1] = std::clamp(0.5 - std::sqrt(inside), from, to);
      cuts[2] = std::clamp(0.5 + std::sqrt(inside), from, to);
      std::sort(cuts.begin(), cuts.end());
    }
  }
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    consider(cuts[i]);
    if ((slope_sign(c, cuts[i]) < 0) != (slope_sign(c, cuts[i + 1]) < 0)) {
      consider(sign_change(c, cuts[i], cuts[i + 1]));
    }
  }
  consider(to);
  return least;
}

/// The share of the way where the clearance first falls to zero for certain in a hiding piece: at its
/// beginning, or where the parabola does.
double first_below(const Ray& ray, const SightPiece& piece) {
  const double width = piece.to - piece.from;
  return piece.from + width * first_zero(ray.high(piece.from) - piece.ground_from + piece.deviation,
                                         ray.high(piece.to) - piece.ground_to + piece.deviation,
                                         ray.bend * width * width);
}

/// True when every piece before `hidden` is visible and `hidden` is what it is in the full TIN.
/// A line that a vertex alone hides has no such piece: then all pieces have to be visible.
bool is_first_for_certain(const SightLine& view, const SightPiece* hidden) {
  const auto first = std::find_if(view.pieces.begin(), view.pieces.end(), [](const auto& p) {
    return p.verdict != PieceVerdict::kVisible;
  });
  return first == view.pieces.end() ? hidden == nullptr
                                    : &*first == hidden && is_final_truth(*hidden);
}

bool is_true_everywhere(const SightLine& view) {
  return std::all_of(view.pieces.begin(), view.pieces.end(), is_final_truth);
}

/// @returns whether the clearance is that of the full TIN
bool set_clearance(const SightLine& line, const SightPair& pair, SightResult& result) {
  Lowest lowest{kInfinity, 0.0};
  const Touch& touch = line.least_touch();
  double least = touch.least;
  double most = touch.most;
  for (const SightPiece& p : line.pieces) {
    least = std::min(least, p.least);
    most = std::min(most, p.most);
    if (p.surface && p.guess < lowest.value) {
      lowest = {p.guess, p.guess_at};
    }
  }
  if (touch.guess < lowest.value) {
    lowest = {touch.guess, touch.at};
  }
  if (line.pieces.empty() || !std::isfinite(lowest.value)) {
    return (line.pieces.empty() || touch.least == kInfinity) &&
           std::all_of(line.pieces.begin(), line.pieces.end(), [](const auto& p) {
             return p.final;  // what was read has no surface
           });
  }
  const bool known = line.ray().is_known() && !(touch.least < std::min(touch.most, most)) &&
                     std::none_of(line.pieces.begin(), line.pieces.end(), [&](const auto& p) {
                       return p.least < most && !is_final_truth(p);
                     });
  result.clearance_min = known ? lowest.value : least;
  result.clearance_max = known ? lowest.value : most;
  result.clearance_at = point_at(pair, line, lowest.at, result.length);
  return !(result.clearance_min < result.clearance_max);
}

void measure_line(const SightLine& line, const SightFacts& facts, const SightPair& pair,
                  double wavelength, SightResult& result) {
  double voids = 0.0;
  bool whole = true;  // every piece is final; else the budget ended first
  LeastRatio least{kInfinity, 0.0};
  for (const SightPiece& p : line.pieces) {
    if (facts.has_voids && !p.settled) {
      voids = std::numeric_limits<double>::quiet_NaN();
    }
    whole = whole && p.final;
    if (!p.surface) {
      voids += facts.has_voids ? (p.to - p.from) * result.length : 0.0;  // else it was not read
      continue;
    }
    const LeastRatio ratio =
        least_fresnel_ratio(p.from, line.ray().middle(p.from) - p.ground_from, p.to,
                            line.ray().middle(p.to) - p.ground_to, line.ray().bend);
    least = ratio.ratio < least.ratio ? ratio : least;
  }
  result.void_length = voids;
  if (wavelength > 0 && whole && least.ratio < kInfinity) {
    // The zone's radius is sqrt(wavelength d1 d2 / (d1 + d2)) with d1 = s L, d2 = (1 - s) L.
    result.fresnel_ratio = least.ratio / std::sqrt(wavelength * result.length);
    result.fresnel_at = point_at(pair, line, least.at, result.length);
  }
}

}  // namespace

PointState state_of(const SightEnd& end) {
  return !end.inside ? PointState::kOutside
                     : (end.surface ? PointState::kSurface : PointState::kVoid);
}

SightPoint point_at(const SightPair& pair, const SightLine& line, double share, double length) {
  return {{pair.a.x + share * (pair.b.x - pair.a.x), pair.a.y + share * (pair.b.y - pair.a.y)},
          share,
          share * length,
          line.ray().middle(share)};
}

bool measure(const SightLine& line, const SightFacts& facts, const SightPair& pair,
             double wavelength, SightResult& result) {
  bool is_true = true;
  if (result.verdict == SightVerdict::kHidden) {
    const SightPiece* hidden = line.hidden_piece();
    const double share = hidden != nullptr ? first_below(line.ray(), *hidden) : 2.0;
    is_true = is_first_for_certain(line, hidden) && line.knows_levels() &&
              !line.may_be_touched_from_below();
    if (std::min(share, line.touched_at()) <= 1.0) {
      result.obstruction = point_at(pair, line, std::min(share, line.touched_at()), result.length);
    }
  }
  if (wavelength > 0 || facts.has_voids) {
    measure_line(line, facts, pair, wavelength, result);
  } else {
    result.void_length = 0.0;
  }
  return set_clearance(line, pair, result) && is_true && std::isfinite(result.void_length) &&
         (wavelength == 0 || is_true_everywhere(line));
}

}  // namespace ptin
