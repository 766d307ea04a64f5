// SPDX-License-Identifier: GPL-3.0-or-later
//
// Selective refinement (paper, section 4): the records for which a predicate is true are retrieved,
// sorted topologically and applied to T0. All questions of this sub-room begin with it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/refine/bounded_surface.h"
#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"

namespace ptin::paper {

/// A mesh that begins as T0 and is refined step by step.
///
/// It knows minh(t) and maxh(t) of each triangle (paper, section 5.3), and how far the full surface
/// deviates from it at most: those of the record that made the triangle. Every record that refines
/// the triangle later depends on that one, so its saturated attributes are no larger. The maker of a
/// triangle is the record of the corner of least rank: a triangle appears with the last of its
/// corners, and every corner of a fan has a larger rank than the record that splits the fan.
/// Threads: one owner.
class SelectiveRefinement final : public BoundedSurface {
 public:
  /// @param terrain  Borrowed for the life of the mesh.
  /// @param detail   Records that it leaves out are not added, but for those that the parameter
  ///                 `beyond` of refine() names.
  SelectiveRefinement(const OpenedTerrain& terrain, const Detail& detail);

  [[nodiscard]] const Tin& tin() const noexcept override { return refinement_.tin(); }

  /// The pages that may hold records for which a monotone predicate is true, ascending: the search
  /// of the paper's trees, by the index in use (paper, section 5.4).
  /// @throws Error corruption, cancelled, io_error
  [[nodiscard]] std::vector<PageId> search(const AttributePredicate& predicate,
                                           QueryContext& context) const;
  /// Bytes that the mesh may take with the records of these pages.
  [[nodiscard]] std::uint64_t bytes_with(std::span<const PageId> pages) const;

  /// Adds the records for which a monotone predicate is true and that are not there yet.
  /// @param beyond  Monotone, or null: a record for which this is true too is added although the
  ///                level of detail leaves it out.
  /// @returns how many were added
  /// @throws Error resource_exhausted (before a page is read), corruption, cancelled, io_error;
  ///               after an error the mesh must be thrown away
  std::size_t refine(const AttributePredicate& predicate, QueryContext& context,
                     const AttributePredicate* beyond = nullptr) {
    return refine(search(predicate, context), predicate, context, beyond);
  }
  /// As refine(), for pages that the caller searched with the same predicate.
  std::size_t refine(std::span<const PageId> pages, const AttributePredicate& predicate,
                     QueryContext& context, const AttributePredicate* beyond = nullptr);

  /// Bounds of the full surface below triangle `t`; infinite for a triangle of T0.
  [[nodiscard]] SurfaceBounds bounds(TriangleId t) const noexcept override;

  /// Bytes that the mesh holds, the records that were added last included.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Frees memory that only another refine() would use.
  void release_records() noexcept;

 private:
  /// What is kept of the record that made a vertex.
  struct Made {
    HeightBits lowest, highest;
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

}  // namespace ptin::paper
