// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/grid_precision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/error.h"

namespace ptin {

void require_resolvable(const AffineMap& map, std::int64_t columns, std::int64_t rows,
                        const std::string& remedy, const std::string& context) {
  const MapPoint low = map.to_map(0.0, 0.0);
  const MapPoint high = map.to_map(static_cast<double>(columns), static_cast<double>(rows));
  const auto is_fine = [](double a, double b, double step) {
    return std::max(std::abs(a), std::abs(b)) / step <= kMostStepsFromZero;
  };
  if (is_fine(low.x, high.x, map.step_x) && is_fine(low.y, high.y, map.step_y)) {
    return;
  }
  char text[200];
  std::snprintf(text, sizeof text,
                "steps of %g and %g are too fine for coordinates such as %.15g %.15g, which are "
                "kept as doubles",
                map.step_x, map.step_y, high.x, high.y);
  throw Error(ErrorCode::invalid_argument, text + ("; " + remedy), context);
}

void warn_of_shift(double shift, const TerrainFrame& frame, const std::string& file,
                   SourceWarnings& warnings) {
  const double most = frame.horizontal_unit == "degree" ? 1e-8 : 1e-3;
  if (shift <= most) {
    return;
  }
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the coordinates have more digits than a grid keeps that reaches so far, and were "
      "rounded to steps of %g, which moved the farthest by %.3g; where that is enough say "
      "so with --resolution %g, else build parts of the source",
      frame.map.step_x, shift, frame.map.step_x);
  warnings.add({.kind = "dropped_digits", .message = text, .file = file});
}

}  // namespace ptin
