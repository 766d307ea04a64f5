// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/curvature.h"

#include <cmath>

#include "engine/error.h"

namespace ptin {

void check(const Curvature& curvature) {
  if (!(curvature.coefficient >= 0) || !std::isfinite(curvature.coefficient)) {
    throw Error(ErrorCode::invalid_argument,
                "the curvature coefficient is negative or not finite: expected 0 (a flat Earth) "
                "to 1 (no refraction)");
  }
  if (!(curvature.earth_diameter > 0)) {
    throw Error(ErrorCode::invalid_argument, "the Earth's diameter is not positive");
  }
}

}  // namespace ptin
