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

/// The triangles of a mesh that levels cross.
struct Crossings {
  std::vector<std::uint32_t> bands;   ///< Beside the vertices.
  std::vector<std::uint8_t> traced;   ///< Beside the triangles: 1 where a line may pass.
  std::vector<std::uint64_t> begin;   ///< Of each level in `triangles`; one more at the end.
  std::vector<TriangleId> triangles;  ///< By level; in a level each once.
};
/// Marks beside the triangles that tracing needs.
inline constexpr std::uint64_t kTraceBytesATriangle = sizeof(std::uint32_t) + 1;

/// What was found, or what it would have taken.
struct FoundCrossings {
  bool found = false;
  std::uint64_t bytes = 0;  ///< What finding and tracing take.
  TraceCounts counts;
  Crossings crossings;
};

/// Finds the triangles of `scope` that each level crosses. Nothing is found when that and tracing
/// would take more than `most_bytes`, beside mesh and pieces.
/// @throws Error cancelled
/// Cost: linear in the mesh, and in what is crossed.
[[nodiscard]] FoundCrossings find_crossings(const Tin& tin, const LevelSet& levels,
                                            const HeightEncoding& heights, const TraceScope& scope,
                                            std::uint64_t most_bytes, const QueryContext& context);

}  // namespace ptin
