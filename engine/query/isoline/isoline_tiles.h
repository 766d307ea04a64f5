// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pieces of a whole terrain's isolines, tile by tile: each tile is refined and traced by
// itself, on any number of threads, within a limit on memory.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/isoline_trace.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/region.h"

namespace ptin {

struct TileTraceRequest {
  const LevelSet& levels;
  /// Records that tracing needs: monotone, and above the tolerance of `detail`.
  PredicatePtr predicate;
  const Detail& detail;        ///< Records that it leaves out are dropped.
  const GridRegion* region;    ///< Only triangles that meet it are traced; null: all.
  std::uint64_t memory_bytes;  ///< For the tiles in work, on all threads together.
  std::uint64_t piece_bytes;   ///< For the pieces, kBytesAPiece each.
  int threads;
  std::stop_token stop;
  /// Bytes of the records and the mesh of a tile, where the memory allows. Tiles of 16 to 64 MiB
  /// are as fast as each other within 5 %; tiles of 8 MiB are 18 % slower, tiles of 128 MiB 8 %.
  std::uint64_t tile_bytes = std::uint64_t{32} << 20;
};

/// Bytes that a piece takes until its line is written: the piece, a line of its own, and what
/// joining needs.
inline constexpr std::uint64_t kBytesAPiece = 192;

struct TileTraces {
  std::vector<IsolinePiece> pieces;
  TraceCounts counts;
  std::uint64_t tiles = 0;
};

/// Traces a terrain tile by tile. The points go to `points`, to which the pieces refer; the pieces
/// come in no particular order. Tiles are small enough for the processor's caches, since one mesh
/// of everything is twice as slow. A tile is halved when its records (known from the index) or its
/// crossings (known before it is traced) do not fit the memory.
/// @param cost  What the tiles cost is added.
/// @throws Error resource_exhausted  a tile that cannot be made small enough, or too many pieces;
///                                   says what would do
///               corruption, io_error, cancelled; as PointStore::add
[[nodiscard]] TileTraces trace_tiles(const OpenedTerrain& terrain, const TileTraceRequest& request,
                                     PointStore& points, QueryCost& cost);

}  // namespace ptin
