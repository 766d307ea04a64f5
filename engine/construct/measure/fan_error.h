// SPDX-License-Identifier: GPL-3.0-or-later
//
// The error of one fan over all samples that it covers.
#pragma once

#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"

namespace ptin {

/// The own part of a collapse, in height codes, rounded up.
struct FanError {
  double error = 0.0;  ///< Residuals, and charges for samples of the wrong class; may be +infinity.
  double deviation = 0.0;  ///< Residuals alone: the deviation at samples.
};

/// For each sample of a gathered star (further corners of blocks and padding included): the number
/// of the fan triangle that it goes to, and its |residual| there, in height codes. The element of a
/// block has those of its south-western sample.
struct FanAssignment {
  std::vector<double> triangle;
  std::vector<double> residual;
};

/// Measures a fan over every sample of the star, and assigns each sample to a fan triangle. A
/// sample on a spoke goes to the side of its own class. Blocks are measured but not assigned
/// (construct/collapse/sample_hand_over.h takes them apart).
/// @param fan   Its buffer `is_surface` may be overwritten.
/// @param full  That of measure_with_voids().
/// REQUIRES: gather_samples() and gather_sources() were called. Cost: samples times degree.
[[nodiscard]] FanError measure_fan(const Tile& tile, const StarSamples& s, FanFrame& fan,
                                   const FullSurface* full, FanAssignment& assignment);

/// Assigns the elements with a direction.
void assign_directed(const Tile& tile, const StarSamples& s, const FanFrame& frame,
                     FanAssignment& assignment);

/// Moves elements on a spoke to the side of their own class. Changes `assignment.triangle` alone:
/// the residual is the same on both sides.
void assign_by_class(const Tile& tile, const StarSamples& s, const FanFrame& frame,
                     FanAssignment& assignment);

/// A bound in codes as records hold it: in the height's unit, rounded up.
[[nodiscard]] float height_bound(double codes, const HeightEncoding& heights) noexcept;

}  // namespace ptin
