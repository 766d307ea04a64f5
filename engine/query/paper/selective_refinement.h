// SPDX-License-Identifier: GPL-3.0-or-later
//
// A refinement that grows question by question and knows, for each of its triangles, what the full
// surface under it can be: the certificates of locate and sight.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/refine/bounded_surface.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"

namespace ptin {

/// A mesh that starts as T0 and to which closed sets of records are added, one after the other.
///
/// The bounds of a triangle are those of the record that made it. Every record that refines the
/// triangle later depends on that one, so its saturated attributes are no larger. The maker of a
/// triangle is the record of the corner of least rank: a triangle appears with the last of its
/// corners, and every corner of a fan has a larger rank than the record that splits the fan.
/// Threads: one owner.
class BoundedMesh final : public BoundedSurface {
 public:
  explicit BoundedMesh(const OpenedTerrain& terrain)
      : BoundedMesh(terrain, Detail(terrain.store())) {}
  /// @param terrain  Borrowed for the life of the mesh.
  /// @param detail   Records that it leaves out are not added, but for those that the parameter
  ///                 `beyond` of refine() names.
  BoundedMesh(const OpenedTerrain& terrain, const Detail& detail);

  [[nodiscard]] const Tin& tin() const noexcept override { return refinement_.tin(); }

  /// Adds the records for which a monotone predicate is true and that are not there yet.
  /// @param beyond  Monotone, or null: a record for which this is true too is added although the
  ///                level of detail leaves it out.
  /// @returns how many were added
  /// @throws Error resource_exhausted (before a page is read), corruption, cancelled, io_error;
  ///               after an error the mesh must be thrown away
  std::size_t refine(const AttributePredicate& predicate, QueryContext& context,
                     const AttributePredicate* beyond = nullptr);

  /// As refine(), for pages that the caller searched with the same predicate.
  std::size_t refine(std::span<const PageId> pages, const AttributePredicate& predicate,
                     QueryContext& context, const AttributePredicate* beyond = nullptr);

  /// The pages whose attributes satisfy the predicate, ascending.  @throws Error corruption,
  /// cancelled
  [[nodiscard]] std::vector<PageId> search(const AttributePredicate& predicate,
                                           QueryContext& context) const;

  /// Bounds of the full surface below triangle `t`; infinite for a triangle of T0.
  [[nodiscard]] SurfaceBounds bounds(TriangleId t) const noexcept override;

  /// Bytes that the mesh holds, the records that were added last included.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Frees memory that only another refine() would use.
  void release_records() noexcept;

 private:
  /// What is kept of the record that made a vertex.
  struct Made {
    double lowest, highest;  ///< Codes.
    float deviation;
    std::uint32_t rank;
  };

  const OpenedTerrain& terrain_;
  Detail detail_;
  Refinement refinement_;
  std::vector<Made> made_;      ///< For each vertex.
  std::vector<Made> entering_;  ///< For each of `splits_`.
  std::vector<VertexSplit> records_;
  std::vector<PendingSplit> splits_;
};

}  // namespace ptin
