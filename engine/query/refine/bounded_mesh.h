// SPDX-License-Identifier: GPL-3.0-or-later
//
// A refinement that grows question by question and knows, for each of its triangles, what the full
// surface under it can be: the certificates of locate and sight.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/refine/refinement.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"

namespace ptin {

/// What holds of everything below one triangle of a refinement.
struct SurfaceBounds {
  double deviation = 0.0;  ///< Vertical distance to the full surface, height's unit, where both are
                           ///< surface.
  Interval heights;        ///< Codes of the full surface; empty: nothing but void.
};

/// A mesh that starts as T0 and to which closed sets of records are added, one after the other.
///
/// The bounds of a triangle are those of the record that made it: whatever record refines the
/// triangle later depends on that one, so its saturated attributes are no larger. (That record is
/// the one of the corner of least rank: a triangle appears with the last of its corners, and what a
/// fan stands on has a larger rank.) Threads: one owner.
class BoundedMesh {
 public:
  explicit BoundedMesh(const OpenedTerrain& terrain)
      : BoundedMesh(terrain, Detail(terrain.store())) {}
  /// @param detail  Records that it leaves out are not added, unless a question goes beyond it.
  BoundedMesh(const OpenedTerrain& terrain, const Detail& detail);

  [[nodiscard]] const Tin& tin() const noexcept { return refinement_.tin(); }

  /// Adds the records for which a monotone predicate is true and that are not there yet.
  /// @param beyond  Monotone; records for which it is true come in although the detail leaves them
  ///                out. None: null.
  /// @returns how many were added
  /// @throws Error resource_exhausted (before anything is read), corruption, cancelled, io_error;
  /// after an error the mesh must be thrown away
  std::size_t refine(const AttributePredicate& predicate, QueryContext& context,
                     const AttributePredicate* beyond = nullptr);

  /// As refine(), for pages that the caller searched with the same predicate.
  std::size_t refine(std::span<const PageId> pages, const AttributePredicate& predicate,
                     QueryContext& context, const AttributePredicate* beyond = nullptr);

  /// Pages whose attributes satisfy the predicate.  @throws Error corruption
  [[nodiscard]] std::vector<PageId> search(const AttributePredicate& predicate,
                                           QueryContext& context) const;

  [[nodiscard]] SurfaceBounds bounds(TriangleId t) const noexcept;

  /// What it holds, the records that were added last included.
  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Gives back what only another refine() would use.
  void release_records() noexcept;

 private:
  /// Of the record that made a vertex.
  struct Made {
    double lowest, highest;  ///< Codes.
    float deviation;
    std::uint32_t rank;
  };

  const OpenedTerrain& terrain_;
  Detail detail_;
  Refinement refinement_;
  std::vector<Made> made_;      ///< Beside the vertices.
  std::vector<Made> entering_;  ///< Beside `splits_`.
  std::vector<VertexSplit> records_;
  std::vector<PendingSplit> splits_;
};

}  // namespace ptin
