// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a line of sight still needs to know: the records near some stretches of it, and at its ends.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/walk/spot.h"
#include "storage/attributes.h"

namespace ptin {

/// True for records that a stretch of the line meets, whose deviation is too large for it and whose
/// surface may reach up to it; and at the ends, for those whose deviation is too large for them,
/// whatever the tolerance. Monotone: exact integers and comparisons.
class SightPredicate final : public AttributePredicate {
 public:
  struct Stretch {
    double from = 0.0, to = 0.0;  ///< Shares of the way.
    double deviation = -1.0;      ///< Records at or below it are left out; negative: none are.
    double lowest_code = 0.0;     ///< So are those whose heights end below this.
    bool beyond = false;          ///< Records within the tolerance are wanted too.
  };

  /// @param end_deviation  As Stretch::deviation, at p and q; infinite: nothing is asked there.
  SightPredicate(Spot p, Spot q, std::vector<Stretch> stretches, double end_deviation,
                 double tolerance);

  [[nodiscard]] bool holds(const Attributes& a) const noexcept override;

  /// What it wants whatever the level of detail: at the ends, and of stretches that say so.
  [[nodiscard]] SightPredicate beyond() const;

 private:
  Spot p_, q_;
  std::vector<Stretch> stretches_;
  std::vector<GridBox> around_;  ///< Beside the stretches: boxes around them, outward.
  GridBox whole_;                ///< Around all of them.
  double end_deviation_, tolerance_;
};

}  // namespace ptin
