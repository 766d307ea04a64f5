// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tightening: true errors and deviations for records that were ordered by carried samples
// (engine/DESIGN.md, section 5.7).
#pragma once

#include <span>
#include <vector>

#include "engine/construct/hierarchy/segment.h"
#include "engine/construct/tile/started_tile.h"
#include "engine/mesh/tin.h"

namespace ptin {

/// A segment to be replayed. Borrows what it names.
struct ReplaySegment {
  std::span<const VertexSplit> records;        ///< In the order of the collapses.
  std::vector<BoundsRaise>* raises = nullptr;  ///< Receives what the leaf shows of them.
};

/// Replays the splits of a chain of segments, root first, over all samples of one leaf. Each record
/// is measured over the leaf's samples and its part of the full surface. A record whose own error
/// or deviation there is more than it says gets an entry in `raises`.
///
/// Only records whose roi meets the leaf are applied. They are closed under
/// dependency, and every fan that touches the leaf is among theirs. A sample begins in a triangle
/// of T0 and goes, split by split, to a triangle that replaces its own. So whichever records a
/// refinement applies, the sample is in a triangle over which it was measured. A sample that is a
/// vertex at the time is not measured, as in construction.
///
/// @param chain  Segments of the leaf's ancestors, the root's first.
/// @param t0     The coarsest TIN: what the root's collapses left. Every vertex alive.
/// @param leaf   The leaf as start_raster_tile(), PointTileStarter or start_tin_tile() gives it.
///     Used up.
/// @throws Error resource_exhausted  as SampleLists::take
/// Over a raster with whole codes and no void near, samples are not handed on at all: each fan asks
/// a pyramid of the leaf (construct/measure/plane_blocks.h), and looks at those squares of samples
/// alone that might show more than the record says already.
/// Cost: about 2.5 residuals a sample for each halving of the vertices above the leaf; with the
/// pyramid a few squares for each triangle of a fan.
void replay_over_leaf(std::span<const ReplaySegment> chain, const Tin& t0, StartedTile&& leaf);

}  // namespace ptin
