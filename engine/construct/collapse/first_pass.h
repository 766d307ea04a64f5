// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first pass of a build that leaves out fine detail (--max-error): most of what will be left
// out goes without a queue.
#pragma once

#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// The share of the largest error that the first pass takes. More would save more time and cost
/// vertices at that error: engine/DECISIONS.md, section 5.1, has the figures.
inline constexpr double kFirstPassShare = 0.7;

/// Replaces the full TIN of a started tile by right triangles over some of its samples
/// (right_triangles.h), whose residuals are at most `tolerance`, in codes. The other samples go to
/// the lists of their triangles. What a triangle stands for is a record with its error, its
/// deviation and its heights, as if a collapse had made it: never larger than the largest error of
/// the build, so it is left out of the file like any other below it.
/// REQUIRES: the samples of `box` fill tile.tin.vertices row by row (start_raster_tile()), nothing
/// was collapsed, and locked vertices are on the border of the box.
/// Cost: linear. Memory: about 200 bytes for each vertex that is left.
void run_first_pass(Tile& tile, const FullSurface& full, const GridBox& box, double tolerance);

}  // namespace ptin
