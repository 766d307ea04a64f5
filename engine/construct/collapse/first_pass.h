// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first pass of a build that leaves out fine detail (--max-error): most of the samples that no
// file keeps go without a queue (engine/DESIGN.md, section 5.5).
#pragma once

#include "engine/construct/tile/full_surface.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/construct/tile/tile.h"
#include "engine/geometry/box.h"

namespace ptin {

/// The tolerance of the first pass is this share of --max-error. A larger share would save more
/// time and cost vertices at that error: engine/DECISIONS.md, section 5.1, has the figures.
inline constexpr double kFirstPassShare = 0.7;

/// Replaces the full TIN of a started tile by right triangles over some of its samples
/// (construct/collapse/right_triangles.h). The other samples go to the lists of their triangles,
/// with residuals of at most `tolerance`. A triangle that leaves something out carries a record
/// with its error, its deviation and its heights, as if a collapse had made it. The error of such a
/// record is below --max-error, so no file keeps it.
/// @param around     With the samples of `box`, of a margin of kDecidingMargin and of voids as
///     SurroundedGrid asks for them: neighbouring tiles leave the same samples on their common sides.
///     Empty: all samples on the border of `box` stay.
/// @param tolerance  In height codes.
/// REQUIRES: the samples of `box` fill tile.tin.vertices row by row (start_raster_tile()); nothing
/// was collapsed; locked vertices are on the border of `box`.
/// Cost: linear. Memory: about 200 bytes for each vertex that is left.
void run_first_pass(Tile& tile, const FullSurface& full, const GridBox& box,
                    const SurroundingSamples& around, double tolerance);

}  // namespace ptin
