// SPDX-License-Identifier: GPL-3.0-or-later
//
// The monotone predicates (engine/DESIGN.md, section 2.3): once true, true for everything larger. Built from
// comparisons, +, x and square roots of sums of squares, each of which keeps its order under
// rounding, so they are monotone in floating point too.
//
// Predicates are immutable values behind a shared pointer: a composition keeps its parts alive, and
// nothing is borrowed unless asked for. Threads: callable from several threads at once.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/query/select/region.h"
#include "storage/attributes.h"

namespace ptin {

/// A monotone predicate that can tell, of all records of a page or a subtree at once, that it is
/// true for them: what two questions agree on need not be looked at. All predicates below are.
class BoundedPredicate : public AttributePredicate {
 public:
  /// True only when holds(r) for every r whose roi is not empty and lies in `all.roi`, whose
  /// heights lie in `all.heights` (or are empty), and whose error is at least `least_error`. Falls
  /// as `all` grows or `least_error` falls; false where it is not certain.
  [[nodiscard]] virtual bool holds_for_all(const Attributes& all,
                                           double least_error) const noexcept = 0;
};

/// True above a bound, which, unlike error_above()'s tolerance, may be negative (always true) or
/// infinite (never). Monotone, exact. Threads: immutable.
class AboveError final : public BoundedPredicate {
 public:
  explicit AboveError(double bound) : bound_(bound) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override { return a.error > bound_; }
  [[nodiscard]] bool holds_for_all(const Attributes&, double least_error) const noexcept override {
    return least_error > bound_;
  }

 private:
  double bound_;
};

/// True when `roi` meets a closed box in grid units: monotone, and exact, since both are integers.
/// Threads: const functions may be called at once. Cost: four comparisons; throws nothing.
class MeetsBox final : public AttributePredicate {
 public:
  explicit MeetsBox(const GridBox& box) : box_(box) {}
  [[nodiscard]] bool holds(const Attributes& a) const noexcept override {
    return meets(a.roi, box_);
  }
  [[nodiscard]] GridBox reach() const noexcept override { return box_; }

 private:
  GridBox box_;
};

using PredicatePtr = std::shared_ptr<const AttributePredicate>;

/// A predicate that the caller keeps alive, as a part of what goes before it does.
[[nodiscard]] PredicatePtr borrowed(const AttributePredicate& predicate);

/// Always true: every record, the full TIN.
[[nodiscard]] PredicatePtr everything();

/// `roi` meets the region.  @throws Error invalid_argument as GridRegion
[[nodiscard]] PredicatePtr meets_region(const Region& region, const AffineMap& map);

/// `error` > tolerance (height's unit): what is left out is certified within it.
/// @throws Error invalid_argument unless tolerance >= 0
[[nodiscard]] PredicatePtr error_above(double tolerance);

/// `heights` contains `height` (height's unit): what an isoline needs.
/// @throws Error invalid_argument when not finite
[[nodiscard]] PredicatePtr contains_height(double height, const HeightEncoding& heights);

/// `heights` meets [low, high] (height's unit); infinite ends are fine.
/// @throws Error invalid_argument when NaN or inverted
[[nodiscard]] PredicatePtr heights_meet(double low, double high, const HeightEncoding& heights);

/// A level of detail that falls off with the distance from an eye.
struct View {
  MapPoint eye;                      ///< Map units.
  std::optional<double> eye_height;  ///< Height's unit; none measures distance in the plane.
  double tau = 0.001;  ///< Error allowed at distance 1: a pixel's angle, in radians. >= 0.
  /// Ground units (those of heights) in a map unit: 1 for a projected CRS in the height's unit;
  /// metres a degree, at the eye, for a geographic one.
  double ground_per_map_x = 1.0;
  double ground_per_map_y = 1.0;
};

/// `error` > tau * distance(roi, eye), where the distance of a 3-D eye is to the box of roi and
/// heights; rounded down. So a record left out has at most tau times the distance of anything that
/// depends on it as its error.
/// @throws Error invalid_argument when a value is not finite, tau is negative or a ground factor is
/// not positive
[[nodiscard]] PredicatePtr seen_from(const View& view, const AffineMap& map,
                                     const HeightEncoding& heights);

/// True when every part is (an empty list: everything).
[[nodiscard]] PredicatePtr all_of(std::vector<PredicatePtr> parts);
/// True when some part is (an empty list: nothing).
[[nodiscard]] PredicatePtr any_of(std::vector<PredicatePtr> parts);

}  // namespace ptin
