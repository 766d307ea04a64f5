// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces of isolines: what one mesh gives; and whole lines, joined from the pieces of several.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/isoline/isoline_cut.h"
#include "engine/query/isoline/point_store.h"
#include "engine/query/select/accounting.h"

namespace ptin {

/// A part of one isoline, in the triangles of one mesh.
struct IsolinePiece {
  std::uint32_t level = 0;
  bool ring = false;        ///< Closed in itself; the first point comes again as the last.
  CutEdge begin, end;       ///< Edges through which it comes and goes; of a ring: not set.
  CutEdge smallest;         ///< Of all edges that it crosses: names the line, whatever the tiles.
  std::uint64_t first = 0;  ///< Of its points. No two in a row are equal.
  std::uint32_t count = 0;  ///< May be 1: all cuts at one vertex.
  std::uint32_t smallest_at = 0;  ///< Index of the point on `smallest`; 0 for a ring.
};

/// A whole isoline: pieces one behind the other.
struct JoinedLine {
  std::uint32_t level = 0;
  bool ring = false;
  CutEdge smallest;
  std::uint64_t first_piece = 0;  ///< In JoinedLines::order.
  std::uint32_t pieces = 0;
};

struct JoinedLines {
  std::vector<JoinedLine> lines;     ///< By level, then by smallest edge.
  std::vector<std::uint32_t> order;  ///< Indices of pieces.
};

/// Joins pieces where one ends on the edge on which another of the same level begins. The lines,
/// their order and where rings begin (on their smallest edge) do not depend on how the terrain was
/// cut into meshes.
/// @throws Error cancelled
/// Cost: O(n log n) in the pieces.
[[nodiscard]] JoinedLines join_pieces(std::span<const IsolinePiece> pieces,
                                      const QueryContext& context);

/// The points of a line, without repetitions in a row; those of a ring end with the first. Empty
/// when they are all one point.
/// @throws Error io_error
void points_of(const JoinedLine& line, const JoinedLines& joined,
               std::span<const IsolinePiece> pieces, const PointStore& store,
               std::vector<MapPoint>& out);

/// Leaves out lines that are one point: all their cuts are at one vertex, a peak at the level.
/// @throws Error io_error
void drop_single_points(JoinedLines& joined, std::span<const IsolinePiece> pieces,
                        const PointStore& store);

}  // namespace ptin
