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
#include "engine/mesh/tin.h"
#include "engine/query/isoline/isoline_cut.h"
#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/region.h"
#include "storage/layout.h"
#include "storage/living_stars.h"

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

struct TraceCounts {
  std::uint64_t triangles = 0;  ///< Crossed by at least one level.
  std::uint64_t vertices = 0;   ///< Corners in the tile of triangles that a level crosses.
  std::uint64_t segments = 0;   ///< One for each triangle and level that crosses it.
};

/// Pieces of lines, and their points in map units.
struct TracedPieces {
  std::vector<IsolinePiece> pieces;
  std::vector<MapPoint> points;
};

/// Traces every level through triangles, which come in any order, with higher ground on the right. A
/// line ends where the surface does, at a border or a void, and where the triangles do.
///
/// Of a star the lines are followed from triangle to triangle as these lie side by side around its
/// centre: a chain. Only the ends of chains are joined by the edges on which they lie.
/// Threads: one owner. What was allocated is used again.
class LineTracer {
 public:
  /// @param levels, heights, map  Borrowed for the life of the tracer.
  LineTracer(const LevelSet& levels, const HeightEncoding& heights, const AffineMap& map)
      : levels_(levels), heights_(heights), map_(map) {}

  /// Forgets all triangles.
  /// @param most_bytes  What the triangles to come may take, joining included, pieces not.
  void begin(const TraceScope& scope, std::uint64_t most_bytes);

  /// Adds the triangles that live of all stars, surface and void. False when there is no room for
  /// them: then nothing can be asked for until begin() is called.
  /// Cost: linear in the corners, and in the segments.
  [[nodiscard]] bool add(const LivingStars& stars);
  [[nodiscard]] bool add(const LivingTriangle& t);
  /// A triangle of a mesh that is alive.
  [[nodiscard]] bool add(const Tin& tin, TriangleId t);

  /// Joins what was added and adds the pieces and their points to `out`. May be called once.
  /// REQUIRES: no add() was false.
  /// @throws Error cancelled
  /// Cost: linear in the segments.
  void join(const QueryContext& context, TracedPieces& out);

  [[nodiscard]] const TraceCounts& counts() const noexcept { return counts_; }
  /// Bytes that what was added takes, and what had no room.
  [[nodiscard]] std::uint64_t bytes_wanted() const noexcept { return bytes_wanted_; }
  /// Most bytes that so many segments take.
  [[nodiscard]] static std::uint64_t bytes_for(std::uint64_t segments) noexcept {
    return segments * (kBytesAChain + 2 * kBytesAPoint);
  }

 private:
  /// Cuts of one line, one behind the other: at each edge that it crosses within a star.
  struct Chain {
    CutEdge begin, end, smallest;
    std::uint32_t level, first, count;  ///< Its points, of which each lies on an edge.
    std::uint32_t smallest_at;          ///< Which of its points lies on `smallest`.
    std::uint32_t next = kNone;         ///< The chain that begins where this one ends.
    bool is_next = false;               ///< Of another chain.
    bool is_taken = false;
  };
  /// The place of a chain in the table of begins.
  struct Slot {
    std::uint32_t tag;
    std::uint32_t chain = kNone;
  };
  struct Step {
    CutEdge edge;
    MapPoint point;
  };
  /// A corner with a height.
  struct Corner {
    GridPoint position;
    std::uint32_t height;  ///< Ordered.
  };
  /// Arrays double while they grow; points are copied twice when lines are made of them.
  static constexpr std::uint64_t kBytesAChain = 2 * sizeof(Chain) + 2 * sizeof(Slot);
  static constexpr std::uint64_t kBytesAPoint = 5 * sizeof(MapPoint);

  [[nodiscard]] bool add_star(const LivingStar& star, std::span<const LivingCorner> ring);
  void find_wanted(const LivingStar& star, std::span<const LivingCorner> ring);
  void count_vertices(std::size_t triangles);
  void trace_level(std::uint32_t level, std::size_t triangles);
  [[nodiscard]] bool has_room(std::size_t segments);
  [[nodiscard]] Step cut(const Corner& below, const Corner& above,
                         std::uint32_t level) const noexcept;
  [[nodiscard]] Step spoke(const Corner& corner, bool is_centre_above,
                           std::uint32_t level) const noexcept;
  void begin_chain(const Step& step, std::uint32_t level);
  void extend_chain(const Step& step);
  [[nodiscard]] Corner corner_of(GridPoint position, HeightBits height) const noexcept;

  [[nodiscard]] static std::uint64_t hash_of(const CutEdge& edge, std::uint32_t level) noexcept;
  [[nodiscard]] std::size_t home(std::uint64_t hash) const noexcept {
    return static_cast<std::size_t>(((hash >> 32) * slots_.size()) >> 32);
  }
  void link(const QueryContext& context);
  void note_begin(std::uint32_t chain) noexcept;
  [[nodiscard]] std::uint32_t chain_from(const CutEdge& edge, std::uint32_t level) const noexcept;
  void take_line(std::uint32_t start, bool ring, TracedPieces& out);
  void emit(IsolinePiece piece, std::size_t smallest, TracedPieces& out);

  const LevelSet& levels_;
  const HeightEncoding& heights_;
  const AffineMap& map_;
  TraceScope scope_;
  std::uint64_t most_bytes_ = 0, bytes_wanted_ = 0;
  TraceCounts counts_;
  std::vector<Chain> chains_;
  std::vector<MapPoint> points_;
  std::vector<Slot> slots_;
  KeyTable vertices_;
  std::vector<MapPoint> line_;  ///< Of the piece at hand.
  /// Of the star at hand: its centre, its corners, and of each triangle whether it is traced.
  Corner centre_{};
  std::array<Corner, layout::kMostDegree + 1> corners_{};
  std::array<bool, layout::kMostDegree + 1> is_wanted_{}, is_crossed_{};
};

/// Traces the surface triangles of a mesh. False, and nothing is traced, when that would take more than
/// `most_bytes`, not counting mesh and pieces.
/// @throws Error cancelled
/// Cost: linear in the mesh, and in the segments.
[[nodiscard]] bool trace_mesh(const Tin& tin, const TraceScope& scope, std::uint64_t most_bytes,
                              const QueryContext& context, LineTracer& tracer, TracedPieces& out);

}  // namespace ptin
