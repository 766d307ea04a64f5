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

/// Traces every level through the triangles of `scope` and adds its pieces, in map units, with
/// higher ground on the right. A line ends where the surface does, at a border or a void, and where
/// the scope does.
/// @param fixed_bytes  What the caller holds already, for the limit of `context`.
/// @throws Error resource_exhausted (before tracing), cancelled; as PointStore::add
/// Cost: linear in the mesh, and in what is crossed.
TraceCounts trace_isolines(const Tin& tin, const LevelSet& levels, const HeightEncoding& heights,
                           const AffineMap& map, const TraceScope& scope, std::uint64_t fixed_bytes,
                           const QueryContext& context, std::vector<IsolinePiece>& pieces,
                           PointStore& points);

}  // namespace ptin
