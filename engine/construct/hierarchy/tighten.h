// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tightening: true errors and deviations for records that were ordered by witnesses (engine/DESIGN.md, section 5.7).
#pragma once

#include <span>
#include <vector>

#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A segment of a chain, and where what a leaf shows of its records goes.
struct ReplaySegment {
  std::span<const VertexSplit> records;  ///< In the order of the collapses.
  std::vector<BoundsRaise>* raises = nullptr;
};

/// Replays the splits of a chain of segments, root first, over all samples of one leaf, and notes
/// for each record the own error and deviation that the leaf's samples and its part of the full
/// surface show, where they are more than the record says.
///
/// Only records whose region of influence meets the leaf are applied: they are closed under
/// dependency, and each fan that touches the leaf is there. A sample begins in a triangle of T0 and
/// goes, split by split, to a triangle that replaces its own: so whichever records a refinement
/// applies, it is in a triangle over which it was measured. Samples that are vertices at the time
/// are not measured, as in construction.
///
/// @param chain  Segments of the leaf's ancestors, the root's first.
/// @param t0     The coarsest TIN: what the root's collapses left. Every vertex alive.
/// @param leaf   The leaf as it was started: start_raster_tile(), PointTileStarter,
///               start_tin_tile(). Used up.
/// Cost: about 2.5 residuals a sample for each halving of the vertices above the leaf.
void replay_over_leaf(std::span<const ReplaySegment> chain, const Tin& t0, StartedTile&& leaf);

}  // namespace ptin
