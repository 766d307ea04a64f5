// SPDX-License-Identifier: GPL-3.0-or-later
//
// How deep each sample of a raster lies in its class: the distance to the nearest sample of the
// other class.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "engine/construct/grid/crs.h"

namespace ptin {

/// Distances are looked for up to this many samples unless the caller says otherwise.
inline constexpr int kVoidDepthCutOff = 64;

/// A window of a raster's mask with what surrounds it: row-major from the south, 0 for void.
struct MaskWindow {
  std::span<const std::uint8_t> valid;  ///< width * height bytes.
  std::int64_t width = 0, height = 0;
  std::int64_t inner_x = 0, inner_y = 0;  ///< Where the wanted window begins in it.
  std::int64_t inner_width = 0, inner_height = 0;
};

/// The steps on the ground at row `y` of the mask window: GroundMetric::at() of that row.
using GroundStepOfRow = std::function<GroundStep(std::int64_t y)>;

/// The depth of each sample of the inner window: its distance in ground units to the nearest sample
/// of the other class (void for a sample with a height, and the other way round), measured with the
/// ground steps of its own row: sqrt((dx * step.x)^2 + (dy * step.y)^2), least over all samples of
/// the other class. Infinite where that exceeds `cut_off` times the smaller of the two steps. The
/// smaller step counts as at least a 64th of the larger one, so that no depth is 0 on the row of a
/// pole.
///
/// Law: a sample's depth depends on the samples within `cut_off` columns and rows of it alone. So
/// with a margin of `cut_off` samples on each side (less only where the raster ends) a window has
/// the depths of the whole, to the last bit: squared distances are integers (the squared ratio of
/// the steps is rounded to 24 bits after the point, and exact for square pixels), so no order of
/// comparisons matters.
///
/// @param depth  Receives inner_width * inner_height values, row-major from the south.
/// @throws Error invalid_argument  a span is not of its size; the inner window does not lie in the
///                                 mask; a row's steps are not finite, one is negative or both are
///                                 0; the cut-off is not within 1 .. 4096
/// Cost: linear, whatever the cut-off; where only one class is in sight, one look at the mask.
/// Memory: 2 bytes a sample of the window, none where only one class is in sight.
/// Threads: any number of calls at once.
void void_depth(const MaskWindow& mask, const GroundStepOfRow& step_of_row, int cut_off,
                std::span<float> depth);

}  // namespace ptin
