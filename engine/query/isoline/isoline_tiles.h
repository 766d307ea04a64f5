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
  PredicatePtr predicate;      ///< Which records are needed; monotone. With the detail's tolerance.
  const Detail& detail;        ///< Records that it leaves out are dropped.
  const GridRegion* region;    ///< Triangles that meet it are traced; null: all.
  std::uint64_t memory_bytes;  ///< For the tiles in work, on all threads together.
  std::uint64_t piece_bytes;   ///< For the pieces, at kBytesAPiece.
  int threads;
  std::stop_token stop;
  /// Of records and mesh of a tile, where the memory allows. Tiles of 16 to 64 MiB are as fast as
  /// each other within 5 %, of 8 MiB 18 % and of 128 MiB 8 % slower.
  std::uint64_t tile_bytes = std::uint64_t{32} << 20;
};

/// What a piece takes until its line is written: itself, in a line of its own, while it is joined.
inline constexpr std::uint64_t kBytesAPiece = 192;

struct TileTraces {
  std::vector<IsolinePiece> pieces;
  TraceCounts counts;
  std::uint64_t tiles = 0;
};

/// Traces a terrain into `points`. Tiles are small enough for the processor's caches, since one
/// mesh of everything is twice as slow; and halved on when their records (known from the index) or
/// what is crossed (known before it is traced) do not fit. Pieces come in no order.
/// @throws Error resource_exhausted  a tile that cannot be made small enough, too many pieces; says
///                                   what would do
///               corruption, io_error, cancelled; as PointStore::add
[[nodiscard]] TileTraces trace_tiles(const OpenedTerrain& terrain, const TileTraceRequest& request,
                                     PointStore& points, QueryCost& cost);

}  // namespace ptin
