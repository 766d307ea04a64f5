// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a line of sight still needs to know: the predicate of records near some stretches of the
// line, and at its ends.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/shape/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// True for a record in two cases. Near a stretch: the roi meets the stretch, the deviation is too
/// large for it, and the error is above the tolerance unless the stretch goes beyond it. At an end:
/// the roi holds the end, and the deviation is too large for the ends, whatever the tolerance.
/// Monotone: exact integers and comparisons.
class SightPredicate final : public AttributePredicate {
 public:
  struct Stretch {
    double from = 0.0, to = 0.0;  ///< Shares of the way.
    /// Records of at most this deviation are left out; negative: none are.
    double deviation = -1.0;
    bool beyond = false;  ///< Records within the tolerance are wanted too.
  };

  /// @param p, q           The ends of the line.
  /// @param end_deviation  As Stretch::deviation, for records at p and q; infinite: none are wanted
  ///                       there.
  /// @param tolerance      Records of at most this error are left out near stretches; negative:
  ///                       none are.
  SightPredicate(Spot p, Spot q, std::vector<Stretch> stretches, double end_deviation,
                 double tolerance);

  [[nodiscard]] bool holds(const Attributes& a) const noexcept override;

  /// The part of the predicate that goes beyond the level of detail: the ends, and the stretches
  /// with `beyond`.
  [[nodiscard]] SightPredicate beyond() const;

 private:
  Spot p_, q_;
  std::vector<Stretch> stretches_;
  std::vector<GridBox> around_;  ///< For each stretch a box around it, rounded outward.
  GridBox whole_;                ///< Around all of them.
  double end_deviation_, tolerance_;
};

}  // namespace ptin
