// SPDX-License-Identifier: GPL-3.0-or-later
//
// The monotone predicates (engine/DESIGN.md, section 2.3): once true, true for everything larger.
// They are built from comparisons, +, x and square roots of sums of squares. Each of these keeps
// its order under rounding, so the predicates are monotone in floating point too.
//
// Predicates are immutable values behind a shared pointer: a composition keeps its parts alive, and
// only borrowed() borrows. Threads: callable from several threads at once.
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

/// True for records of an error above a bound (height's unit). Unlike the tolerance of
/// error_above(), the bound may be negative (always true) or infinite (never true). Monotone,
/// exact. Threads: immutable.
class AboveError final : public AttributePredicate {
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
  [[nodiscard]] bool holds_for_all(const Attributes& all, double) const noexcept override {
    return contains(box_, all.roi);
  }

 private:
  GridBox box_;
};

using PredicatePtr = std::shared_ptr<const AttributePredicate>;

/// A predicate of the caller's, as a part of a composition. Nothing is copied: the caller keeps it
/// alive at least as long as the composition.
[[nodiscard]] PredicatePtr borrowed(const AttributePredicate& predicate);

/// Always true: every record, the full TIN.
[[nodiscard]] PredicatePtr everything();

/// True when `roi` meets the region.  @throws Error invalid_argument as GridRegion
[[nodiscard]] PredicatePtr meets_region(const Region& region, const AffineMap& map);

/// True when `error` > tolerance (height's unit): records left out have at most this error.
/// @throws Error invalid_argument unless tolerance >= 0
[[nodiscard]] PredicatePtr error_above(double tolerance);

/// True when `heights` contains `height` (height's unit): the records that an isoline needs.
/// @throws Error invalid_argument when not finite
[[nodiscard]] PredicatePtr contains_height(double height, const HeightEncoding& heights);

/// True when `heights` meets [low, high] (height's unit); infinite ends are fine.
/// @throws Error invalid_argument when NaN or inverted
[[nodiscard]] PredicatePtr heights_meet(double low, double high, const HeightEncoding& heights);

/// A level of detail that falls off with the distance from an eye.
struct View {
  MapPoint eye;                      ///< Map units.
  std::optional<double> eye_height;  ///< Height's unit; none measures distance in the plane.
  double tau = 0.001;  ///< Error allowed at ground distance 1: a pixel's angle, in radians. >= 0.
  /// Ground units (those of heights) in a map unit: 1 for a projected CRS in the height's unit;
  /// metres a degree, at the eye, for a geographic one.
  double ground_per_map_x = 1.0;
  double ground_per_map_y = 1.0;
};

/// True when `error` > tau * d, where d is the ground distance from the eye to the roi; for an eye
/// with a height, to the box of roi and heights. d is rounded down. So the error of a record left
/// out is at most tau times the distance of anything that depends on the record.
/// @throws Error invalid_argument when a value is not finite, tau is negative or a ground factor is
/// not positive
[[nodiscard]] PredicatePtr seen_from(const View& view, const AffineMap& map,
                                     const HeightEncoding& heights);

/// True when every part is true (an empty list: always).
/// @throws Error invalid_argument when a part is null
[[nodiscard]] PredicatePtr all_of(std::vector<PredicatePtr> parts);
/// True when some part is true (an empty list: never).
/// @throws Error invalid_argument when a part is null
[[nodiscard]] PredicatePtr any_of(std::vector<PredicatePtr> parts);

}  // namespace ptin
