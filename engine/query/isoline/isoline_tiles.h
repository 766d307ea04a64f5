// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pieces of a whole terrain's isolines, tile by tile: of each tile the triangles that a level
// crosses are gathered and traced, on any number of threads, within a limit on memory.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "engine/query/isoline/isoline.h"
#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/isoline_trace.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
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

/// Where what was traced is put together. Threads: add() may be called at once.
class TraceCollector {
 public:
  /// @param points  Borrowed; takes the points of all pieces.
  /// @param file    Named in errors.
  TraceCollector(const TileTraceRequest& request, PointStore& points, std::string file)
      : points_(points), most_pieces_(request.piece_bytes / kBytesAPiece), file_(std::move(file)) {}

  /// Adds a tile.
  /// @throws Error resource_exhausted  there are too many pieces; as PointStore::add
  void add(const TracedPieces& traced, const TraceCounts& counts);
  [[nodiscard]] TileTraces release() { return std::move(all_); }

 private:
  std::mutex mutex_;
  PointStore& points_;
  std::uint64_t most_pieces_;
  std::string file_;
  TileTraces all_;
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

/// A way to the pieces of a terrain's isolines: trace_tiles(), or as the paper has it.
using TraceTerrain = std::function<TileTraces(const TileTraceRequest&, PointStore&, QueryCost&)>;

/// isolines() of the pieces that `trace` finds.
/// @throws Error as isolines(), and what `trace` throws
[[nodiscard]] Isolines extract_isolines(const OpenedTerrain& terrain, const IsolineRequest& request,
                                        const TraceTerrain& trace);

}  // namespace ptin
