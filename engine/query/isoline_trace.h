// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of one mesh, by walking from triangle to triangle (paper, section 5.2).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/accounting.h"
#include "engine/query/isoline_pieces.h"
#include "engine/query/levels.h"
#include "engine/query/region.h"

namespace ptin {

/// Which triangles of a mesh are traced: those that belong to a tile, and meet a region.
struct TraceScope {
  /// A triangle belongs to the tile that holds its corner of the smallest key. Tiles that share no
  /// grid point and cover the domain have each triangle once.
  GridBox tile;
  const GridRegion* region = nullptr;  ///< Borrowed; null: everywhere.
};

struct TraceCounts {
  std::uint64_t triangles = 0;  ///< Crossed by at least one level.
  std::uint64_t vertices = 0;   ///< Of those triangles, in the tile.
  std::uint64_t segments = 0;   ///< One a triangle and level.
};

struct TraceResult {
  bool traced = false;
  std::uint64_t bytes = 0;  ///< What tracing takes.
  TraceCounts counts;
};

/// Traces every level through the triangles of `scope` and adds its pieces and their points, in
/// map units, with higher ground on the right. A line ends where the surface does, at a border or a
/// void, and where the scope does. Nothing is traced when that would take more than `most_bytes`,
/// beside mesh and pieces.
/// @throws Error cancelled
/// Cost: linear in the mesh, and in what is crossed.
TraceResult trace_isolines(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                           const AffineMap& map, const TraceScope& scope, std::uint64_t most_bytes,
                           const QueryContext& context, std::vector<IsolinePiece>& pieces,
                           std::vector<MapPoint>& points);

/// The triangles of a mesh that levels cross.
struct Crossings {
  std::vector<std::uint32_t> bands;   ///< Beside the vertices.
  std::vector<std::uint8_t> traced;   ///< Beside the triangles: 1 where a line may pass.
  std::vector<std::uint64_t> begin;   ///< Of each level in `triangles`; one more at the end.
  std::vector<TriangleId> triangles;  ///< By level; in a level each once.
};
/// Marks beside the triangles that tracing needs.
inline constexpr std::uint64_t kTraceBytesATriangle = sizeof(std::uint32_t) + 1;

/// As trace_isolines(), where it is known already what is crossed.
/// Cost: linear in what is crossed, and marks beside the triangles.
void trace_crossings(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                     const AffineMap& map, const Crossings& crossings, const QueryContext& context,
                     std::vector<IsolinePiece>& pieces, std::vector<MapPoint>& points);

}  // namespace ptin
