// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pieces of a whole terrain's isolines, tile by tile: of each tile the triangles that a level
// crosses are gathered and traced, on any number of threads, within a limit on memory. Or from one
// mesh of splits.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/region.h"
#include "engine/query/shape/tiler.h"

namespace ptin {

struct TileTraceRequest {
  const LevelSet& levels;
  const Detail& detail;
  const GridRegion* region;  ///< Only triangles that meet it are traced; null: all.
  /// Pages on the borders of tiles are read for each of them, so one thread is better off with large
  /// tiles; several share many small ones out.
  TileLimits tiles;
  std::uint64_t piece_bytes;  ///< For the pieces, kBytesAPiece each.
  std::stop_token stop;
  bool counts_vertices = false;  ///< TraceScope::counts_vertices.
};

/// Bytes that a piece takes until its line is written: the piece, a line of its own, and what
/// joining needs.
inline constexpr std::uint64_t kBytesAPiece = 192;

struct TileTraces {
  std::vector<IsolinePiece> pieces;
  TraceCounts counts;
  std::uint64_t tiles = 0;
};

/// Traces a terrain tile by tile, from the triangles that live at the level and that a level
/// crosses. The points go to `points`, to which the pieces refer; the pieces come in no particular
/// order. A tile is halved when its triangles or its crossings do not fit the memory.
/// @param cost  What the tiles cost is added.
/// @throws Error resource_exhausted  a tile that cannot be made small enough, or too many pieces;
///                                   says what would do
///               corruption, io_error, cancelled; as PointStore::add
/// Cost: the stars with heights at a level, those on pages of several tiles once for each; linear in
/// the segments.
[[nodiscard]] TileTraces trace_tiles(const OpenedTerrain& terrain, const TileTraceRequest& request,
                                     PointStore& points, QueryCost& cost);

/// The same as the paper has it: the records of which `predicate` is true (all that the levels may
/// cross above the tolerance of the level of detail) are applied to T0, and that one mesh is traced.
/// @throws Error resource_exhausted  the mesh does not fit the memory: told before it is read
///               as trace_tiles()
[[nodiscard]] TileTraces trace_by_splits(const OpenedTerrain& terrain,
                                         const TileTraceRequest& request,
                                         const AttributePredicate& predicate, PointStore& points,
                                         QueryCost& cost);

}  // namespace ptin
