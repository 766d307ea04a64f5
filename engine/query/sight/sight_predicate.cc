// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/sight_predicate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace ptin {

namespace {

std::int32_t clamped(double v) noexcept {
  return static_cast<std::int32_t>(std::clamp(v, -2147483648.0, 2147483647.0));
}

/// A box around the stretch, at least one grid unit wider on each side, which is more than rounding
/// needs.
GridBox box_around(Spot p, Spot q, double from, double to) noexcept {
  const MapPoint a = grid_of(p);
  const MapPoint b = grid_of(q);
  const double x0 = a.x + from * (b.x - a.x);
  const double x1 = a.x + to * (b.x - a.x);
  const double y0 = a.y + from * (b.y - a.y);
  const double y1 = a.y + to * (b.y - a.y);
  return {clamped(std::floor(std::min(x0, x1)) - 1), clamped(std::floor(std::min(y0, y1)) - 1),
          clamped(std::ceil(std::max(x0, x1)) + 1), clamped(std::ceil(std::max(y0, y1)) + 1)};
}

}  // namespace

SightPredicate::SightPredicate(Spot p, Spot q, std::vector<Stretch> stretches, double end_deviation,
                               double tolerance)
    : p_(p),
      q_(q),
      stretches_(std::move(stretches)),
      end_deviation_(end_deviation),
      tolerance_(tolerance) {
  for (const Stretch& s : stretches_) {
    around_.push_back(box_around(p, q, s.from, s.to));
    whole_ = united(whole_, around_.back());
  }
}

bool SightPredicate::holds(const Attributes& a) const noexcept {
  if (a.deviation > end_deviation_ && (contains(a.roi, p_) || contains(a.roi, q_))) {
    return true;
  }
  if (!meets(a.roi, whole_) || !line_meets(p_, q_, a.roi)) {
    return false;
  }
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    const Stretch& s = stretches_[i];
    if (a.deviation > s.deviation && (a.error > tolerance_ || s.beyond) &&
        meets(a.roi, around_[i])) {
      return true;
    }
  }
  return false;
}

SightPredicate SightPredicate::beyond() const {
  std::vector<Stretch> stretches;
  std::copy_if(stretches_.begin(), stretches_.end(), std::back_inserter(stretches),
               [](const Stretch& s) { return s.beyond; });
  return {p_, q_, std::move(stretches), end_deviation_, tolerance_};
}

}  // namespace ptin
