// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of one mesh, by walking from triangle to triangle (paper, section 5.2).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/isoline/isoline_crossings.h"
#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"

namespace ptin {

struct TraceResult {
  bool traced = false;      ///< False: nothing was traced, since it would take too much.
  std::uint64_t bytes = 0;  ///< Bytes that tracing takes.
  TraceCounts counts;
};

/// What is traced. All borrowed.
struct TraceSource {
  const Tin& tin;
  const LevelSet& levels;
  const HeightEncoding& heights;
  const AffineMap& map;
};

/// Pieces of lines, and their points in map units.
struct TracedPieces {
  std::vector<IsolinePiece> pieces;
  std::vector<MapPoint> points;
};

/// Traces every level through the triangles of `scope` and adds the pieces and their points to
/// `out`, with higher ground on the right. A line ends where the surface does, at a border or a
/// void, and where the scope does. Nothing is traced when that would take more than `most_bytes`,
/// not counting mesh and pieces.
/// @throws Error cancelled
/// Cost: linear in the mesh, and in the segments.
TraceResult trace_isolines(const TraceSource& source, const TraceScope& scope,
                           std::uint64_t most_bytes, const QueryContext& context,
                           TracedPieces& out);

/// As trace_isolines(), for crossings that are known already.
/// @throws Error cancelled
/// Cost: linear in the crossings, plus a mark for each triangle.
void trace_crossings(const TraceSource& source, const Crossings& crossings,
                     const QueryContext& context, TracedPieces& out);

}  // namespace ptin
