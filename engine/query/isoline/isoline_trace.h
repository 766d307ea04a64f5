// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of triangles in any order, by what they have in common: the edges that they cross.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/box.h"
#include "engine/geometry/height.h"
#include "engine/geometry/key_table.h"
#include "engine/query/isoline/isoline_cells.h"
#include "engine/query/isoline/isoline_chains.h"
#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/living/living_stars.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/region.h"
#include "storage/layout.h"

namespace ptin {

/// Which triangles are traced: those that belong to a tile, and meet a region.
struct TraceScope {
  /// Grid units, closed. A triangle belongs to the tile that holds its corner of the smallest key.
  /// Tiles that share no grid point and cover the domain have each triangle once.
  GridBox tile{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX};
  const GridRegion* region = nullptr;  ///< Borrowed; null: everywhere.
  /// Count the corners of the triangles crossed: a look-up by key for each.
  bool counts_vertices = false;
};

/// Pieces of lines, and their points in map units.
struct TracedPieces {
  std::vector<IsolinePiece> pieces;
  std::vector<MapPoint> points;
};

/// Traces every level through triangles, which come in any order, with higher ground on the right. A
/// line ends where the surface does, at a border or a void, and where the triangles do.
///
/// Lines are followed within a star from triangle to triangle, as these lie side by side around its
/// centre, or within a square of a raster: a chain. Chains are joined by the edges on which they end, those that came one after the
/// other first.
/// Threads: one owner. What was allocated is used again.
class LineTracer {
 public:
  /// @param levels, heights, map, context  Borrowed for the life of the tracer.
  LineTracer(const LevelSet& levels, const HeightEncoding& heights, const AffineMap& map,
             const QueryContext& context)
      : levels_(levels), heights_(heights), map_(map), context_(context) {}

  /// Forgets all triangles.
  /// @param most_bytes  What the triangles to come may take, joining included, pieces not.
  void begin(const TraceScope& scope, std::uint64_t most_bytes);

  /// Adds the triangles that live of all stars, surface and void. False when there is no room for
  /// them: then nothing can be asked for until begin() is called.
  /// @throws Error cancelled
  /// Cost: linear in the corners, and in the segments.
  [[nodiscard]] bool add(const LivingStars& stars);
  [[nodiscard]] bool add(const LivingTriangle& t);
  /// Whether add() takes a square: not where it counts vertices, nor a large one.
  [[nodiscard]] bool takes(const RasterSquare& square) const noexcept {
    return !scope_.counts_vertices && square.width <= CellLines::kMostSamples &&
           square.height <= CellLines::kMostSamples;
  }
  /// The same of the cells of a raster, of which lines are followed through the whole square.
  /// REQUIRES: takes(square)
  [[nodiscard]] bool add(const RasterSquare& square);

  /// Joins what was added: pieces that end where the triangles do, and rings. May be called once; what
  /// it returns is kept until begin() is called.
  /// REQUIRES: no add() was false.
  /// @throws Error cancelled
  /// Cost: linear in the segments.
  [[nodiscard]] const TracedPieces& join();

  [[nodiscard]] const TraceCounts& counts() const noexcept { return counts_; }
  /// Bytes that what was added takes, and what had no room.
  [[nodiscard]] std::uint64_t bytes_wanted() const noexcept { return bytes_wanted_; }

 private:
  /// A corner with a height.
  using Corner = CellLines::Corner;

  [[nodiscard]] bool add_star(const LivingStar& star, std::span<const LivingCorner> ring);
  void find_wanted(const LivingStar& star, std::span<const LivingCorner> ring);
  void count_vertices(std::size_t triangles);
  void trace_level(std::uint32_t level, std::size_t triangles);
  [[nodiscard]] bool has_room(std::size_t segments);
  [[nodiscard]] ChainSet::Step cut(const Corner& below, const Corner& above,
                                   std::uint32_t level) const noexcept;
  [[nodiscard]] ChainSet::Step spoke(const Corner& corner, bool is_centre_above,
                                     std::uint32_t level) const noexcept;
  [[nodiscard]] Corner corner_of(GridPoint position, HeightBits height) const noexcept;

  void join_batch();
  void put(IsolinePiece piece, std::span<const MapPoint> points);

  const LevelSet& levels_;
  const HeightEncoding& heights_;
  const AffineMap& map_;
  const QueryContext& context_;
  TraceScope scope_;
  std::uint64_t most_bytes_ = 0, bytes_wanted_ = 0;
  TraceCounts counts_;
  ChainSet batch_;   ///< What came last.
  ChainSet chains_;  ///< What batches were joined to.
  TracedPieces traced_;
  KeyTable vertices_;
  CellLines cells_;  ///< Of the square at hand.
  /// The star at hand: its centre, its corners, and of each triangle whether it is traced.
  Corner centre_{};
  std::array<Corner, layout::kMostDegree + 1> corners_{};
  std::array<bool, layout::kMostDegree + 1> is_wanted_{}, is_crossed_{};
};

}  // namespace ptin
