// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refinement: records put in order and applied to a mesh, which starts as T0 (paper, section 4;
// engine/DESIGN.md, sections 6.2 and 6.3).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/mesh/star.h"
#include "engine/mesh/tin.h"
#include "engine/mesh/vertex_table.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/retrieval.h"

namespace ptin {

/// Bytes of a mesh and its table of vertices. For T0: what a refinement begins with.
[[nodiscard]] std::uint64_t bytes_of(const Tin& tin) noexcept;

/// A mesh that splits are applied to and taken back from. A moving window keeps one, applies what
/// enters and undoes what leaves. Threads: one owner.
class Refinement {
 public:
  /// @param t0           Copied.
  /// @param track_pages  Keep for each triangle the page of the record that made it.
  explicit Refinement(const Tin& t0, bool track_pages = false);

  /// Applies `splits` in the order of refine/apply_order.h, and numbers vertices and triangles
  /// along that order: so what lies near in the terrain mostly lies near in memory. Together with
  /// what was applied before they must be closed under dependency, as the records of a monotone
  /// predicate are. Result: the TIN does not depend on the order of `splits` (the theorem:
  /// engine/DESIGN.md, section 2.4), but its numbering does.
  /// @throws Error corruption  a vertex comes twice, or a record does not find its w, vl, vr and
  ///                           fan; names page and vertex. Throw the refinement away then.
  ///               resource_exhausted  more triangles than 32 bits number
  ///               cancelled
  /// Cost: O(k + largest rank) expected time and memory for k splits of bounded degree.
  void apply(std::span<const PendingSplit> splits, QueryContext& context);

  /// Undoes `splits`, which must be applied, by collapses in the order of rising rank. What stays
  /// must be closed under dependency, as the records of a monotone predicate are. Result: the TIN
  /// of what stays, since a collapse is the exact inverse of its split. The next apply() uses the
  /// places of what went again. REQUIRES: pages are not tracked.
  /// @throws Error corruption  a collapse is not the inverse of its split: the records' attributes
  ///                           are not saturated; names page and vertex. Throw the refinement away
  ///                           then.
  ///               cancelled
  /// Cost: O(k + largest rank) expected for k splits of bounded degree.
  void undo(std::span<const PendingSplit> splits, QueryContext& context);

  /// The splits of the last apply() as indices, in the order in which they were applied. As long as
  /// nothing was undone, their vertices are the last ones of the mesh, in this order.
  [[nodiscard]] std::span<const std::uint32_t> applied_order() const noexcept { return order_; }

  /// The mesh. After undo() it has removed vertices and triangles among the others (mesh/tin.h).
  [[nodiscard]] const Tin& tin() const noexcept { return tin_; }
  /// Vertices and triangles that are not removed. Cost: none.
  [[nodiscard]] std::size_t alive_vertices() const noexcept {
    return tin_.vertices.size() - free_vertices_.size();
  }
  [[nodiscard]] std::size_t alive_triangles() const noexcept {
    return tin_.triangles.size() - free_triangles_.size();
  }
  /// Local index of a vertex, or kNone.
  [[nodiscard]] VertexId find(VertexKey key) const noexcept { return ids_.find(tin_, key); }
  /// Gives the mesh away; the refinement is not used afterwards.
  [[nodiscard]] Tin release_tin() noexcept { return std::move(tin_); }
  /// For each triangle the page of the record that made it, kNone for T0. Empty when pages are not
  /// tracked.
  [[nodiscard]] std::vector<std::uint32_t> release_pages() noexcept {
    return std::move(triangle_pages_);
  }

 private:
  /// What is known of a split before it is applied.
  struct Resolved {
    VertexId u, w;
    std::uint32_t triangle;  ///< Number of its first new triangle among those of its batch.
  };
  /// Where a batch puts its new vertices and triangles: first in the places of removed ones, then
  /// from `first_vertex` and `first_triangle` on.
  struct Batch {
    std::size_t vertices = 0, triangles = 0;
    VertexId first_vertex = 0;
    TriangleId first_triangle = 0;
  };
  [[nodiscard]] VertexId vertex_place(const Batch& batch, std::size_t i) const noexcept {
    return i < free_vertices_.size()
               ? free_vertices_[i]
               : batch.first_vertex + static_cast<VertexId>(i - free_vertices_.size());
  }
  [[nodiscard]] TriangleId triangle_place(const Batch& batch, std::size_t i) const noexcept {
    return i < free_triangles_.size()
               ? free_triangles_[i]
               : batch.first_triangle + static_cast<TriangleId>(i - free_triangles_.size());
  }
  [[nodiscard]] Batch reserve(std::span<const PendingSplit> splits, const QueryContext& context);
  [[nodiscard]] VertexId enter(const PendingSplit& split, VertexId u, const QueryContext& context);
  void apply_one(const PendingSplit& split, const Resolved& resolved, const Batch& batch,
                 const QueryContext& context);
  void apply_one_by_one(std::span<const PendingSplit> splits, const Batch& batch,
                        const QueryContext& context);
  void apply_in_pipeline(std::span<const PendingSplit> splits, const Batch& batch,
                         const QueryContext& context);
  void forget_places(const Batch& batch);
  void undo_one(const PendingSplit& split, Star& star, const QueryContext& context);

  Tin tin_;
  VertexTable ids_;
  std::vector<std::uint32_t> order_;
  std::vector<VertexId> free_vertices_;  ///< Removed: their places are used again.
  std::vector<TriangleId> free_triangles_;
  bool has_void_vertex_ = false;  ///< A vertex without a height is, or was, there.
  bool track_pages_;
  std::vector<std::uint32_t> vertex_pages_,
      triangle_pages_;  ///< The page behind each vertex and triangle, when tracked.
};

}  // namespace ptin
