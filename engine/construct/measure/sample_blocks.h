// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples of one height joined into square blocks, so that flat ground costs its outline and not
// its area.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/construct/measure/fan_measure.h"
#include "engine/construct/measure/star_samples.h"
#include "engine/construct/tile/sample_lists.h"
#include "engine/geometry/height.h"

namespace ptin {

/// Joins samples and blocks of the same height and class, four complete siblings of a quadtree at a
/// time, until no four are left that can be joined. Leaves the elements in the order of that
/// quadtree.
/// REQUIRES: positions are distinct, and the samples are of a raster: a block stands for all grid
/// points inside of it. Cost: one sort.
void join_into_blocks(std::vector<Sample>& samples);

/// The same, where it pays: where there are so many samples that most lie inside of the triangle
/// and not along its border, and more than half have the height of the one before.
/// @param length  About the length of the border of their triangle, grid units.
/// Cost: linear, else one sort.
void join_where_alike(std::vector<Sample>& samples, double length);

/// Bounds the residuals of samples in blocks that lie across a spoke of the fan, in height codes; 0
/// where no block does. A block has one height, so its difference to the fan is linear in each part
/// that the spokes cut it into, and largest at a corner of a part. Such a corner is a corner of the
/// block, which is measured as a sample, or a point where a spoke enters or leaves the block, which
/// is measured here. Rounding is included. Cost: blocks times spokes.
[[nodiscard]] double straddling_residual(const StarSamples& s, const FanFrame& fan) noexcept;

/// The fan triangle that holds all samples of the box from (x0, y0) to (x1, y1), its edges
/// included; fan.triangles() when none does. Coordinates are relative to u.
[[nodiscard]] std::size_t triangle_of_box(const FanFrame& fan, double x0, double y0, double x1,
                                          double y1) noexcept;

}  // namespace ptin
