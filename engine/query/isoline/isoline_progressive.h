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
  std::uint64_t splits = 0;  ///< Vertices that came.
  /// Triangles looked at: those around the vertices that came, each once.
  std::uint64_t triangles = 0;
  std::uint64_t removed = 0;  ///< Pieces that went; a piece is that of one triangle and level.
  std::uint64_t added = 0;    ///< Pieces that came.
  friend bool operator==(const IsolineChange&, const IsolineChange&) = default;
};

/// The isolines of a mesh that only ever grows by splits: the mesh of a StreamReader, or of a
/// Refinement that undoes nothing.
///
/// Why it is local: a split moves the triangles of its fan from w to u and adds two triangles at u.
/// A later split moves a triangle only to a vertex that is newer still. So after any number of
/// splits the triangles that changed are exactly those around the new vertices, and the pieces in
/// all other triangles stay.
///
/// Law: at any time lines() are those of a direct extraction (isoline/isoline.h) from the TIN as it
/// is then, bit for bit and in the same order; after the last split they are those of the terrain.
/// Threads: one owner.
class ProgressiveIsolines {
 public:
  /// A context with a limit of 4 GiB and without a stop token.
  [[nodiscard]] static QueryContext any_context() { return {{}, ""}; }

  /// Begins with the isolines of `tin` as it is, for example T0. `tin` is not kept.
  /// @param context  Kept. Its limit is for bytes(), asked for before memory is taken; its stop
  ///                 token is looked at in every call.
  /// @throws Error resource_exhausted, cancelled
  /// Cost: linear in the mesh.
  ProgressiveIsolines(const Tin& tin, LevelSet levels, const HeightEncoding& heights,
                      const AffineMap& map, QueryContext context = any_context());

  /// Follows `tin`: the mesh of the last call, to which any number of splits have been applied
  /// since. Vertices and triangles that were there have kept their ids, and new vertices came
  /// behind them.
  /// @throws Error resource_exhausted, cancelled. Throw the isolines away then, or restart() them.
  /// Cost: the triangles around the new vertices; logarithmic in the levels. Nothing else is read.
  IsolineChange advance(const Tin& tin);

  /// Begins anew with a mesh of another numbering, for example when a stream goes on from another
  /// one (StreamReader::numbering()).
  /// @throws Error resource_exhausted, cancelled
  /// Cost: linear in the mesh.
  void restart(const Tin& tin);

  /// Number of pieces: one for each surface triangle and level that crosses it.
  [[nodiscard]] std::uint64_t pieces() const noexcept { return slots_.size() - free_.size(); }
  [[nodiscard]] const LevelSet& levels() const noexcept { return levels_; }
  /// Bytes held, without the mesh. Cost: constant.
  [[nodiscard]] std::uint64_t bytes() const noexcept;

  /// The isolines, joined, of the mesh of the last advance(). The caller fills in the certificates.
  /// @throws Error cancelled; resource_exhausted  when bytes() and the lines exceed the context's
  /// memory
  /// Cost: linear in the pieces, plus a look at each triangle; O(n log n) in the lines.
  [[nodiscard]] Isolines lines(const Tin& tin, const QueryContext& context) const;

 private:
  struct Slot {
    TriangleId triangle;
    std::uint32_t level;
    std::uint32_t next;   ///< Slot of the same triangle, or kNone.
    std::uint32_t place;  ///< Index in by_level_[level].
  };
  void remove_pieces(TriangleId t, IsolineChange& change);
  void add_pieces(const Tin& tin, TriangleId t, IsolineChange& change);
  void add_bands(const Tin& tin);
  [[nodiscard]] std::uint32_t pieces_in(const Tin& tin, TriangleId t) const noexcept;
  [[noreturn]] void refuse_more_pieces() const;
  void make_room_for_pieces(std::uint64_t pieces);
  template <typename T>
  void make_room(std::vector<T>& array, std::uint64_t more) const;

  LevelSet levels_;
  HeightEncoding heights_;
  AffineMap map_;
  QueryContext context_;
  std::vector<std::uint32_t> bands_;  ///< For each vertex its band.
  std::vector<std::uint32_t> first_;  ///< For each triangle its first slot, or kNone.
  std::vector<Slot> slots_;           ///< Those in free_ are used again.
  std::vector<std::uint32_t> free_;
  std::vector<std::vector<std::uint32_t>> by_level_;  ///< For each level its slots.
  std::uint64_t level_capacity_ = 0;  ///< Capacity of all arrays in by_level_ together.
  Star star_;
};

}  // namespace ptin
