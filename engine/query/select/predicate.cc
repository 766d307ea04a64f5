// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/select/predicate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/error.h"
#include "engine/geometry/affine_rounding.h"

namespace ptin {

namespace {

class Everything final : public AttributePredicate {
 public:
  [[nodiscard]] bool holds(const Attributes&) const noexcept override { return true; }
  [[nodiscard]] bool holds_for_all(const Attributes&, double) const noexcept override {
    return true;
  }
};

class MeetsRegion final : public AttributePredicate {
 public:
  MeetsRegion(const Region& region, const AffineMap& map) : region_(region, map) {}
  [[nodiscard]] GridBox reach() const noexcept override { return region_.bounds(); }
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return region_.meets(a.roi);
  }
  [[nodiscard]] bool holds_for_all(const Attributes& all, double) const noexcept override {
    return region_.contains(all.roi);
  }

 private:
  GridRegion region_;
};

/// Compares decoded heights, which are what callers see at vertices. Decoding is monotone in the
/// code, so the predicate is monotone too.
class HeightsMeet final : public AttributePredicate {
 public:
  HeightsMeet(double low, double high, const HeightEncoding& heights)
      : low_(low), high_(high), heights_(heights) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return heights_.height_of_code(a.heights.lo) <= high_ &&
           low_ <= heights_.height_of_code(a.heights.hi);
  }
  /// Never certain: a record around which all is void has an empty interval, which meets nothing.
  [[nodiscard]] bool holds_for_all(const Attributes&, double) const noexcept override {
    return false;
  }

 private:
  double low_, high_;
  HeightEncoding heights_;
};

class SeenFrom final : public AttributePredicate {
 public:
  SeenFrom(const View& view, const AffineMap& map, const HeightEncoding& heights)
      : view_(view), heights_(heights), eye_(map.to_grid(view.eye)) {
    ground_x_ = map.step_x * view.ground_per_map_x;
    ground_y_ = map.step_y * view.ground_per_map_y;
    slack_x_ = rounding_to_grid(view.eye.x, map.origin_x, map.step_x, eye_.x);
    slack_y_ = rounding_to_grid(view.eye.y, map.origin_y, map.step_y, eye_.y);
  }

  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    const double dx = gap(a.roi.min_x, a.roi.max_x, eye_.x, slack_x_) * ground_x_;
    const double dy = gap(a.roi.min_y, a.roi.max_y, eye_.y, slack_y_) * ground_y_;
    double squares = dx * dx + dy * dy;
    if (view_.eye_height) {
      const double dz = gap(heights_.height_of_code(a.heights.lo),
                            heights_.height_of_code(a.heights.hi), *view_.eye_height, 0.0);
      squares += dz * dz;
    }
    return a.error > view_.tau * (std::sqrt(squares) * kRoundDown);
  }
  /// Takes the largest distance that a box in `all.roi` can have; each step is monotone under
  /// rounding. For an eye with a height nothing is certain: a record around which all is void is
  /// infinitely far away.
  [[nodiscard]] bool holds_for_all(const Attributes& all,
                                   double least_error) const noexcept override {
    const double dx = farther_end(all.roi.min_x, all.roi.max_x, eye_.x) * ground_x_;
    const double dy = farther_end(all.roi.min_y, all.roi.max_y, eye_.y) * ground_y_;
    return !view_.eye_height &&
           least_error > view_.tau * (std::sqrt(dx * dx + dy * dy) * kRoundDown);
  }

 private:
  /// Sixteen units of rounding: twice what squares, sums, root and products above can add to a
  /// distance.
  static constexpr double kRoundDown = 1.0 - 16 * std::numeric_limits<double>::epsilon();

  /// Distance from v to [lo, hi]: falls as the interval grows. An empty interval (+inf, -inf) is
  /// infinitely far away.
  static double gap(double lo, double hi, double v, double slack) noexcept {
    return std::max(0.0, std::max(lo - v, v - hi) - slack);
  }

  /// At least the gap of every interval within [lo, hi].
  static double farther_end(double lo, double hi, double v) noexcept {
    return std::max(0.0, std::max(hi - v, v - lo));
  }

  View view_;
  HeightEncoding heights_;
  MapPoint eye_;
  double ground_x_ = 1, ground_y_ = 1, slack_x_ = 0, slack_y_ = 0;
};

class AllOf final : public AttributePredicate {
 public:
  explicit AllOf(std::vector<PredicatePtr> parts) : parts_(std::move(parts)) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return std::all_of(parts_.begin(), parts_.end(),
                       [&](const PredicatePtr& p) { return p->holds(a); });
  }
  /// The smallest reach of a part.
  [[nodiscard]] GridBox reach() const noexcept override {
    GridBox least = AttributePredicate::reach();
    for (const PredicatePtr& p : parts_) {
      const GridBox part = p->reach();
      if (half_perimeter(part) < half_perimeter(least)) {
        least = part;
      }
    }
    return least;
  }
  [[nodiscard]] bool holds_for_all(const Attributes& all,
                                   double least_error) const noexcept override {
    return std::all_of(parts_.begin(), parts_.end(),
                       [&](const PredicatePtr& p) { return p->holds_for_all(all, least_error); });
  }

 private:
  std::vector<PredicatePtr> parts_;
};

class AnyOf final : public AttributePredicate {
 public:
  explicit AnyOf(std::vector<PredicatePtr> parts) : parts_(std::move(parts)) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return std::any_of(parts_.begin(), parts_.end(),
                       [&](const PredicatePtr& p) { return p->holds(a); });
  }
  [[nodiscard]] bool holds_for_all(const Attributes& all,
                                   double least_error) const noexcept override {
    return std::any_of(parts_.begin(), parts_.end(),
                       [&](const PredicatePtr& p) { return p->holds_for_all(all, least_error); });
  }

 private:
  std::vector<PredicatePtr> parts_;
};

void check_parts(const std::vector<PredicatePtr>& parts) {
  if (std::find(parts.begin(), parts.end(), nullptr) != parts.end()) {
    refuse("a part of a composed predicate is null");
  }
}

}  // namespace

PredicatePtr borrowed(const AttributePredicate& predicate) {
  return {&predicate, [](const AttributePredicate*) {}};
}

PredicatePtr everything() { return std::make_shared<Everything>(); }

PredicatePtr meets_region(const Region& region, const AffineMap& map) {
  return std::make_shared<MeetsRegion>(region, map);
}

PredicatePtr error_above(double tolerance) {
  if (!(tolerance >= 0)) {
    refuse("the tolerance is negative or not a number: expected a value >= 0 in the height's unit");
  }
  return std::make_shared<AboveError>(tolerance);
}

PredicatePtr contains_height(double height, const HeightEncoding& heights) {
  if (!std::isfinite(height)) {
    refuse("the height is not a finite number");
  }
  return std::make_shared<HeightsMeet>(height, height, heights);
}

PredicatePtr heights_meet(double low, double high, const HeightEncoding& heights) {
  if (!(low <= high)) {
    refuse("the height interval is inverted or not a number: expected low <= high");
  }
  return std::make_shared<HeightsMeet>(low, high, heights);
}

PredicatePtr seen_from(const View& view, const AffineMap& map, const HeightEncoding& heights) {
  if (!std::isfinite(view.eye.x) || !std::isfinite(view.eye.y) ||
      !std::isfinite(view.eye_height.value_or(0.0))) {
    refuse("the eye's position is not finite");
  }
  if (!(view.tau >= 0) || !std::isfinite(view.tau)) {
    refuse("the view's tau is negative or not finite: expected the error allowed at distance 1");
  }
  const auto positive = [](double v) { return v > 0 && std::isfinite(v); };
  if (!positive(view.ground_per_map_x) || !positive(view.ground_per_map_y)) {
    refuse("the view's ground units in a map unit are not positive and finite");
  }
  return std::make_shared<SeenFrom>(view, map, heights);
}

PredicatePtr all_of(std::vector<PredicatePtr> parts) {
  check_parts(parts);
  return parts.size() == 1 ? parts.front() : std::make_shared<AllOf>(std::move(parts));
}

PredicatePtr any_of(std::vector<PredicatePtr> parts) {
  check_parts(parts);
  return parts.size() == 1 ? parts.front() : std::make_shared<AnyOf>(std::move(parts));
}

}  // namespace ptin
