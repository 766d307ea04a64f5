// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces of isolines, as one mesh gives them, and whole lines, joined from the pieces of several
// meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/isoline/isoline_cut.h"
#include "engine/query/isoline/point_store.h"
#include "engine/query/select/accounting.h"

namespace ptin {

/// What levels cross.
struct TraceCounts {
  std::uint64_t triangles = 0;  ///< Crossed by at least one level.
  std::uint64_t vertices = 0;   ///< Their corners, where they are counted.
  std::uint64_t segments = 0;   ///< One for each triangle and level that crosses it.
};

/// A part of one isoline, in the triangles of one mesh.
struct IsolinePiece {
  std::uint32_t level = 0;
  bool ring = false;   ///< Closed in itself: the last point is the first one again.
  CutEdge begin, end;  ///< Edges on which the piece begins and ends; not set for a ring.
  /// Smallest edge that it crosses. The smallest edge of a line names it, whatever the tiles.
  CutEdge smallest;
  std::uint64_t first = 0;  ///< Index of its first point in the PointStore.
  /// Number of its points, no two equal in a row; 1 when all its cuts are at one vertex.
  std::uint32_t count = 0;
  std::uint32_t smallest_at = 0;  ///< Which of its points lies on `smallest`; 0 for a ring.
};

/// A whole isoline: pieces one behind the other.
struct JoinedLine {
  std::uint32_t level = 0;
  bool ring = false;
  CutEdge smallest;
  std::uint64_t first_piece = 0;  ///< Index into JoinedLines::order.
  std::uint32_t pieces = 0;       ///< How many.
};

struct JoinedLines {
  std::vector<JoinedLine> lines;     ///< By level, then by smallest edge.
  std::vector<std::uint32_t> order;  ///< Indices of pieces, line by line.
};

/// Joins pieces of one level: where one piece ends on an edge, the piece that begins on that edge
/// follows. The lines, their order and where rings begin (on their smallest edge) do not depend on
/// how the terrain was cut into meshes.
/// @throws Error cancelled
/// Cost: O(n log n) in the pieces.
[[nodiscard]] JoinedLines join_pieces(std::span<const IsolinePiece> pieces,
                                      const QueryContext& context);

/// Sets `out` to the points of a line (map units), without repetitions in a row; a ring ends with
/// its first point. Empty when all points of the line are one.
/// @throws Error io_error
void points_of(const JoinedLine& line, const JoinedLines& joined,
               std::span<const IsolinePiece> pieces, const PointStore& store,
               std::vector<MapPoint>& out);

/// Drops the lines whose points are all one: all their cuts are at one vertex, a peak at the level.
/// @throws Error io_error
void drop_single_points(JoinedLines& joined, std::span<const IsolinePiece> pieces,
                        const PointStore& store);

}  // namespace ptin
