// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/fan_error.h"

#include <algorithm>

#include "engine/construct/measure/sample_blocks.h"
#include "engine/construct/measure/void_measure.h"
#include "engine/geometry/rounding.h"

namespace ptin {

FanError measure_fan(const Tile& tile, const StarSamples& s, FanFrame& fan, const FullSurface* full,
                     FanAssignment& assignment) {
  assign_samples(s, fan, assignment.triangle, assignment.residual);
  assign_directed(tile, s, fan, assignment);
  if (s.void_only || s.flat) {
    return {};
  }
  const double bound = residual_bound(s, tile.units);
  if (!s.surface_only) {
    assign_by_class(tile, s, fan, assignment);
    const VoidMeasure voids = measure_with_voids(tile, s, fan, full);
    return {certified_residual(voids.error, s, tile.units),
            certified_residual(voids.deviation, s, tile.units)};
  }
  double worst = *std::max_element(assignment.residual.begin(), assignment.residual.end());
  if (!s.blocks.empty()) {
    worst = std::max(worst, straddling_residual(s, fan));
  }
  double error = certified_residual(worst, s, tile.units);
  if (bound > 0.0 && worst <= bound && all_residuals_zero(tile, s, fan)) {
    error = 0.0;
  }
  return {error, error};
}

void assign_by_class(const Tile& tile, const StarSamples& s, const FanFrame& frame,
                     FanAssignment& assignment) {
  const auto class_of = [&](std::size_t i) {
    return tile.tin.classes[s.star.triangles[frame.star_triangle[i]]];
  };
  bool one_class = true;
  for (std::size_t i = 1; i < frame.triangles(); ++i) {
    one_class = one_class && class_of(i) == class_of(0);
  }
  if (one_class) {
    return;
  }
  for (std::size_t k = 0; k < s.source.size(); ++k) {
    if (s.source[k].direction != kNoDirection) {
      continue;
    }
    const bool has_height = s.source[k].reach >= 0.0F;
    const TriangleClass own = has_height ? TriangleClass::kSurface : TriangleClass::kVoid;
    if (class_of(static_cast<std::size_t>(assignment.triangle[k])) != own) {
      assignment.triangle[k] =
          static_cast<double>(triangle_of_sample(tile, s, frame, s.x[k], s.y[k], has_height));
    }
  }
}

void assign_directed(const Tile& tile, const StarSamples& s, const FanFrame& frame,
                     FanAssignment& assignment) {
  for (const DirectedElement& d : s.directed) {
    assignment.triangle[d.element] = static_cast<double>(triangle_of_directed(tile, s, frame, d));
  }
}

float height_bound(double codes, const HeightEncoding& heights) noexcept {
  // A step other than 1 costs one more rounding.
  return rounded_up(heights.step == 1.0 ? codes : scaled_up(codes * heights.step));
}

}  // namespace ptin
