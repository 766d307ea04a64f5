// SPDX-License-Identifier: GPL-3.0-or-later
//
// Progressive isolines: kept up to date, locally, while a mesh is refined (paper, section 5.2).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/geometry/affine.h"
#include "engine/geometry/height.h"
#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"
#include "engine/query/isoline/isoline.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"

namespace ptin {

/// What keeping isolines up to date took.
struct IsolineChange {
  std::uint64_t splits = 0;     ///< Vertices that came.
  std::uint64_t triangles = 0;  ///< Looked at: those around the vertices that came, each once.
  std::uint64_t removed = 0;    ///< Pieces, one a triangle and level that crosses it, that went.
  std::uint64_t added = 0;      ///< Pieces that came.
  friend bool operator==(const IsolineChange&, const IsolineChange&) = default;
};

/// The isolines of a mesh that only ever grows by splits: of a StreamReader, or of a Refinement
/// that undoes nothing.
///
/// Why it is local: a split moves the triangles of its fan from w to u and adds two beside u, and a
/// later one moves a triangle only to a vertex that is newer still. So whatever splits came, the
/// triangles that are not what they were are exactly those around the vertices that came; the
/// pieces in all others stay.
///
/// Law: at any time lines() are those of a direct extraction (isoline.h) from the TIN as it is
/// then, bit for bit and in the same order: after the last split, those of the terrain.
/// Threads: one owner.
class ProgressiveIsolines {
 public:
  /// What is kept may take 4 GiB.
  [[nodiscard]] static QueryContext any_context() {
    return {{.memory_bytes = std::uint64_t{4} << 30}, ""};
  }

  /// The isolines of `tin` as it is: T0, say.
  /// @param context  Its limit is for bytes(), asked for before it is taken; its stop token is
  /// looked at in every call. Kept.
  /// @throws Error resource_exhausted, cancelled
  /// Cost: linear in the mesh.
  ProgressiveIsolines(const Tin& tin, LevelSet levels, const HeightEncoding& heights,
                      const AffineMap& map, QueryContext context = any_context());

  /// Follows `tin`: the mesh of the last call, to which any number of splits have been applied
  /// since, one or many. Vertices and triangles that were there have kept their ids, and new
  /// vertices came behind them.
  /// @throws Error resource_exhausted, cancelled; throw the isolines away then, or restart() them
  /// Cost: the triangles around the new vertices; logarithmic in the levels. Nothing else is read.
  IsolineChange advance(const Tin& tin);

  /// Begins anew with a mesh whose numbering is another one: a stream that goes on from this one.
  /// @throws Error resource_exhausted, cancelled
  /// Cost: linear in the mesh.
  void restart(const Tin& tin);

  /// Pieces there are now: one a surface triangle and level that crosses it.
  [[nodiscard]] std::uint64_t pieces() const noexcept { return slots_.size() - free_.size(); }
  [[nodiscard]] const LevelSet& levels() const noexcept { return levels_; }
  /// Bytes held, but for the mesh. Cost: none.
  [[nodiscard]] std::uint64_t bytes() const noexcept;

  /// The isolines, joined, of the mesh of the last advance(). Certificates are the caller's.
  /// @throws Error cancelled; resource_exhausted  with bytes() more than the context's memory
  /// Cost: linear in the pieces, but for marks beside the triangles; O(n log n) in the lines.
  [[nodiscard]] Isolines lines(const Tin& tin, const QueryContext& context) const;

 private:
  struct Slot {
    TriangleId triangle;
    std::uint32_t level;
    std::uint32_t next;   ///< Slot of the same triangle, or kNone.
    std::uint32_t place;  ///< In by_level_[level].
  };
  void remove_pieces(TriangleId t, IsolineChange& change);
  void add_pieces(const Tin& tin, TriangleId t, IsolineChange& change);
  void add_bands(const Tin& tin);
  [[nodiscard]] std::uint32_t pieces_in(const Tin& tin, TriangleId t) const noexcept;
  void make_room_for_pieces(std::uint64_t pieces);
  template <typename T>
  void make_room(std::vector<T>& array, std::uint64_t more) const;

  LevelSet levels_;
  HeightEncoding heights_;
  AffineMap map_;
  QueryContext context_;
  std::vector<std::uint32_t> bands_;  ///< Beside the vertices.
  std::vector<std::uint32_t> first_;  ///< Beside the triangles: a slot, or kNone.
  std::vector<Slot> slots_;           ///< Those in free_ are used again.
  std::vector<std::uint32_t> free_;
  std::vector<std::vector<std::uint32_t>> by_level_;  ///< Slots.
  std::uint64_t level_capacity_ = 0;                  ///< Of all of by_level_ together.
  Star star_;
};

}  // namespace ptin
