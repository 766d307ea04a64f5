// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN larger than memory, cut into patches that join: every triangle and every vertex is in
// exactly one patch, and their numbers do not depend on how the TIN was cut.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/query/questions.h"
#include "storage/store_file.h"

namespace ptin::tools {

/// The part of a TIN that one cell owns. Surface triangles alone.
///
/// The rule, on exact grid positions: a vertex belongs to the cell that holds it, a triangle to the
/// cell of its corner that comes last along the Hilbert curve. Vertices follow one another along
/// the curve, triangles by the curve positions of their corners, last corner first. With cells
/// visited in the order of the curve, the whole sequence does not depend on the cells, and a
/// triangle refers to no vertex that comes later.
struct TinPatch {
  using Point = std::array<double, 3>;  ///< x, y in map units, height.
  std::uint64_t first_vertex = 0;       ///< Number of vertices[0], from 0 over the whole TIN.
  std::vector<Point> vertices;
  struct Corner {
    std::uint64_t number;  ///< Number of the vertex in the whole TIN.
    VertexId local;        ///< In the part, for point().
  };
  std::vector<std::array<Corner, 3>> triangles;  ///< Counter-clockwise; the last corner first.

  [[nodiscard]] Point point(const Corner& corner) const;
  const Tin* tin = nullptr;           ///< The part of the TIN; borrowed.
  const StoreFacts* facts = nullptr;  ///< Borrowed.
};

/// Makes the patches of one walk (walk_cells()), in its order.
class PatchMaker {
 public:
  /// @param region  Triangles that do not meet it are left out. None keeps all.
  /// @throws Error invalid_argument as GridRegion
  PatchMaker(const StoreFile& store, const std::optional<Region>& region);

  /// The patch of the next cell, of which `tin` is the part. It borrows `tin`.
  /// @throws Error corruption          cells do not join: the file is damaged
  ///               resource_exhausted  the vertices that later cells use take more than
  ///                                   `border_limit_bytes`
  /// Cost: linear in the part; memory as much again as the part.
  [[nodiscard]] TinPatch make(const GridCell& cell, const Tin& tin,
                              std::uint64_t border_limit_bytes);

  [[nodiscard]] std::uint64_t vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::uint64_t triangles() const noexcept { return triangles_; }
  /// To be called after the last cell.  @throws Error corruption  a triangle is missing
  void finish() const;

 private:
  struct Sorted;
  [[nodiscard]] Sorted sort_cell(const GridCell& cell, const Tin& tin) const;
  [[nodiscard]] std::uint64_t number_of(VertexId v, const Tin& tin, const Sorted& sorted);
  [[nodiscard]] bool is_wanted(const Tin& tin, TriangleId t) const;
  [[noreturn]] void throw_damaged() const;

  /// A vertex of an earlier cell that triangles of later cells use.
  struct Open {
    std::uint64_t number;
    std::uint32_t triangles;  ///< How many are still to come.
  };
  const StoreFile& store_;
  std::optional<GridRegion> region_;
  std::unordered_map<VertexKey, Open> open_;
  std::uint64_t vertices_ = 0;
  std::uint64_t triangles_ = 0;
};

}  // namespace ptin::tools
