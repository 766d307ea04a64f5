// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/sight/curvature.h"

#include <cmath>

#include "engine/error.h"

namespace ptin {

void check(const Curvature& curvature) {
  constexpr double kMost = 1000;  // as on a ball of 13 km diameter
  if (!(curvature.coefficient >= 0) || !(curvature.coefficient <= kMost)) {
    refuse(
        "the curvature coefficient is negative or too large: expected 0 (a flat Earth) to 1 (no "
        "refraction)");
  }
  if (!(curvature.earth_diameter > 0)) {
    refuse("the Earth's diameter is not positive");
  }
}

}  // namespace ptin
