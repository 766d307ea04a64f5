// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain of any size refined part by part: boxes of the grid at one level of detail, each within
// a memory limit. Promise P5 joins the parts: they agree on every triangle that meets both.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "engine/geometry/box.h"
#include "engine/query/refine/grid_cell.h"
#include "engine/query/refine/refine.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/query_limits.h"

namespace ptin {

/// What is asked of every part.
struct PartRequest {
  std::optional<Region> region;  ///< Where to refine at all, map units; none: everywhere.
  DetailRequest detail;          ///< The TIN of which the parts are, the same for every region.
  PredicatePtr also;             ///< Any further monotone predicate; none: nothing further.
  QueryLimits limits{.memory_bytes = std::uint64_t{1} << 30};  ///< Of one part.
};

/// Refines parts of a terrain, and knows the memory that a part takes before it reads a page.
/// Threads: const functions may run at once, each within its own limit.
class PartRefiner {
 public:
  /// @param terrain  Borrowed for the life of the refiner.
  /// @throws Error as meets_region() and Detail
  /// Cost: that of Detail.
  PartRefiner(const OpenedTerrain& terrain, PartRequest request);

  /// Most bytes that refine(box) may take, by the index alone. Cost: a search of the index, and the
  /// descriptors of the pages found.
  /// @throws Error corruption
  [[nodiscard]] std::uint64_t bytes_for(const GridBox& box) const;
  [[nodiscard]] bool fits(const GridBox& box) const {
    return bytes_for(box) <= request_.limits.memory_bytes;
  }

  /// Refines one part. The mesh covers the whole domain: every triangle that meets both `box` (grid
  /// units, closed) and the region is one of the TIN of the request (P5); elsewhere the mesh is
  /// coarser. The certificate holds where `box` meets the region.
  /// @throws Error as refine() (refine/refine.h)
  [[nodiscard]] RefinedTin refine(const GridBox& box) const;

  /// Records of the whole file that the level of detail asks for, by the table of errors: at most
  /// one bin of errors too many.
  [[nodiscard]] std::uint64_t records() const noexcept { return records_; }
  [[nodiscard]] const OpenedTerrain& terrain() const noexcept { return terrain_; }
  [[nodiscard]] const Detail& detail() const noexcept { return detail_; }
  [[nodiscard]] const PartRequest& request() const noexcept { return request_; }

 private:
  OpenedTerrain terrain_;
  PartRequest request_;
  Detail detail_;
  PredicatePtr wanted_;  ///< Region, tolerance and `also`.
  std::uint64_t t0_bytes_;
  std::uint64_t records_ = 0;
};

/// Cuts the domain into cells that fit the memory limit and hands each, refined, to `visit` in the
/// order of the Hilbert curve (hilbert_position()). Every vertex lies in exactly one cell. So what
/// is written cell by cell, in the order of the curve, does not depend on where the cuts are.
/// @param visit  Gets the cell, its refinement, and the share of the domain's area that is done
///               after it.
/// @throws Error resource_exhausted  what a single position needs does not fit
///               as PartRefiner::refine, and what `visit` throws
/// Cost: the refinements; a triangle that meets several cells is made in each of them.
void walk_cells(
    const PartRefiner& refiner,
    const std::function<void(const GridCell& cell, RefinedTin& refined, double done)>& visit);

}  // namespace ptin
