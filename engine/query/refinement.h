// SPDX-License-Identifier: GPL-3.0-or-later
//
// Refinement: records sorted by rank and applied to a mesh, which starts as T0 (paper, section 4;
// DESIGN.md, section 7).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/accounting.h"
#include "engine/query/key_table.h"
#include "engine/query/retrieval.h"

namespace ptin {

/// Bytes that reading and applying `records` records may take: records, mesh and key table.
[[nodiscard]] std::uint64_t refinement_bytes(std::uint64_t records) noexcept;

/// A mesh that splits are applied to. Later questions keep one and apply a further closed set to
/// it. Threads: one owner.
class Refinement {
 public:
  /// @param t0           Borrowed for the call.
  /// @param track_pages  Keep for each triangle the page of the record that made it.
  explicit Refinement(const Tin& t0, bool track_pages = false);

  /// Applies `splits` in order of falling rank; equal ranks keep their order, and with it the
  /// file's locality. Together with what was applied before they must be closed under dependency,
  /// as the records of a monotone predicate are. Result: the TIN does not depend on the order of
  /// `splits` (the theorem), but its numbering does.
  /// @throws Error corruption  a vertex comes twice, or a record does not find its w, vl, vr and
  /// fan; names page and vertex.
  ///                           Throw the refinement away then.
  ///               resource_exhausted  more triangles than 32 bits number
  ///               cancelled
  /// Cost: O(k + largest rank) expected time and memory for k splits of bounded degree.
  void apply(std::span<const PendingSplit> splits, QueryContext& context);

  [[nodiscard]] const Tin& tin() const noexcept { return tin_; }
  /// Local index of a vertex, or KeyTable::kAbsent.
  [[nodiscard]] VertexId find(VertexKey key) const noexcept { return ids_.find(key); }
  /// Gives the mesh away; the refinement is spent.
  [[nodiscard]] Tin release_tin() noexcept { return std::move(tin_); }
  /// Beside the triangles: page of the record that made each, kNone for those of T0. Empty when not
  /// tracked.
  [[nodiscard]] std::vector<std::uint32_t> release_pages() noexcept {
    return std::move(triangle_pages_);
  }

 private:
  /// A split in local indices. `triangle` is the place of its first new triangle.
  struct Resolved {
    VertexId u, w, vl, vr;
    TriangleId triangle;
    std::uint32_t flags;
  };
  void reserve(std::span<const PendingSplit> splits, const QueryContext& context);
  void add_vertices(std::span<const PendingSplit> splits, const QueryContext& context);
  [[nodiscard]] std::vector<Resolved> resolve(std::span<const PendingSplit> splits,
                                              VertexId first_vertex, TriangleId first_triangle,
                                              const QueryContext& context) const;
  void apply_one(const Resolved& split, std::span<const PendingSplit> splits,
                 const QueryContext& context);

  Tin tin_;
  KeyTable ids_;
  bool track_pages_;
  std::vector<std::uint32_t> vertex_pages_,
      triangle_pages_;  ///< Beside the mesh's arrays, when tracked.
};

}  // namespace ptin
