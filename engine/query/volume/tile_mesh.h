// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain at a level of detail, tile by tile, with what its full TIN can be below a triangle.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/query/refine/bounded_mesh.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"

namespace ptin {

/// The mesh of one tile after the other, in the same memory. Threads: one owner.
class TileMesh {
 public:
  /// @param terrain, detail  Borrowed.
  /// @param region           Where it is refined at all; null: everywhere.
  TileMesh(const OpenedTerrain& terrain, const Detail& detail, PredicatePtr region);

  /// Most bytes that the mesh of a tile takes, which refine() makes next. Cost: a search.
  /// @throws Error corruption
  [[nodiscard]] std::uint64_t announce(const GridBox& tile, QueryContext& context);
  /// Most triangles that the mesh of the announced tile has.
  [[nodiscard]] std::uint64_t most_triangles() const noexcept { return most_triangles_; }
  /// Refines the tile that was announced: every triangle that meets it and the region is one of the
  /// level's (promise P5).  @throws Error as Refinement::apply
  void refine(QueryContext& context);

  [[nodiscard]] const Tin& tin() const noexcept {
    return bounded_ ? bounded_->tin() : mesh_->tin();
  }
  /// Height's unit, finite. The full TIN is no farther from the triangle where both are surface.
  [[nodiscard]] double deviation(TriangleId t) const noexcept;
  /// The heights that the full TIN can have below the triangle; empty: it is void there.
  [[nodiscard]] Interval heights(TriangleId t) const noexcept;
  /// Whether the level is the full TIN of the source.
  [[nodiscard]] bool is_exact() const noexcept { return detail_.is_exact(facts_); }
  [[nodiscard]] const StoreFacts& facts() const noexcept { return facts_; }

 private:
  const OpenedTerrain& terrain_;
  const Detail& detail_;
  const StoreFacts& facts_;
  PredicatePtr wanted_;
  PredicatePtr in_tile_;
  std::uint64_t most_triangles_ = 0;
  std::vector<PageId> pages_;
  std::vector<PendingSplit> splits_;
  std::optional<Refinement> mesh_;      ///< Of a level that is exact.
  std::optional<BoundedMesh> bounded_;  ///< Of any other.
};

/// The heights of a terrain's source, its base deviation added on either side; empty where there is
/// no surface.
[[nodiscard]] Interval source_heights(const StoreFacts& facts) noexcept;

}  // namespace ptin
