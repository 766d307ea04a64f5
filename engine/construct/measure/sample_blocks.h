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

/// Joins samples and blocks of the same height and class, four complete siblings at a time, as far
/// as it goes; the order changes (to that of a quadtree). Samples must be distinct positions. Only
/// for rasters, where a block's samples are all there is inside of it. Cost: one sort.
void join_into_blocks(std::vector<Sample>& samples);

/// The same where that pays: where there are more samples than a triangle of this length is long,
/// so that it has an inside, and most are like the one before. Cost: linear, else one sort.
void join_where_alike(std::vector<Sample>& samples, double length);

/// Bounds the residuals of samples in blocks that lie across a spoke of the fan; 0 where none does.
/// A block has one height, so the difference to the fan is linear in each part that the spokes cut
/// it into, and largest at a corner of a part: a corner of the block (measured as a sample) or a
/// point where a spoke enters or leaves it (measured here). Rounding included. Cost: blocks times
/// spokes.
[[nodiscard]] double straddling_residual(const StarSamples& s, const FanFrame& fan) noexcept;

/// The fan triangle (closed) that holds all samples of the box from (x0, y0) to (x1, y1), relative
/// to u; fan.triangles() when none does.
[[nodiscard]] std::size_t triangle_of_box(const FanFrame& fan, double x0, double y0, double x1,
                                          double y1) noexcept;

}  // namespace ptin
