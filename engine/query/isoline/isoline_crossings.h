// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which triangles of a mesh isolines cross.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/mesh/tin.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/region.h"

namespace ptin {

/// Which triangles of a mesh are traced: those that belong to a tile, and meet a region.
struct TraceScope {
  /// Grid units, closed. A triangle belongs to the tile that holds its corner of the smallest key.
  /// Tiles that share no grid point and cover the domain have each triangle once.
  GridBox tile;
  const GridRegion* region = nullptr;  ///< Borrowed; null: everywhere.
};

struct TraceCounts {
  std::uint64_t triangles = 0;  ///< Crossed by at least one level.
  std::uint64_t vertices = 0;   ///< Corners in the tile of triangles that a level crosses.
  std::uint64_t segments = 0;   ///< One for each triangle and level that crosses it.
};

/// The triangles of a mesh that levels cross.
struct Crossings {
  std::vector<std::uint32_t> bands;  ///< For each vertex its band (LevelSet::band_of()).
  std::vector<std::uint8_t> traced;  ///< For each triangle 1 where lines are traced.
  /// Where each level begins in `triangles`; one more at the end.
  std::vector<std::uint64_t> begin;
  std::vector<TriangleId> triangles;  ///< Those that each level crosses, level by level.
};
/// Bytes of the marks that tracing needs for each triangle of a mesh.
inline constexpr std::uint64_t kTraceBytesATriangle = sizeof(std::uint32_t) + 1;

/// The crossings found, or how much memory finding them would have taken.
struct FoundCrossings {
  bool found = false;
  std::uint64_t bytes = 0;  ///< Bytes that finding and tracing take.
  TraceCounts counts;
  Crossings crossings;
};

/// Finds the triangles of `scope` that each level crosses. Finds nothing (`found` is false) when
/// finding and tracing would take more than `most_bytes`, not counting mesh and pieces.
/// @throws Error cancelled
/// Cost: linear in the mesh, and in the segments found.
[[nodiscard]] FoundCrossings find_crossings(const Tin& tin, const LevelSet& levels,
                                            const HeightEncoding& heights, const TraceScope& scope,
                                            std::uint64_t most_bytes, const QueryContext& context);

}  // namespace ptin
