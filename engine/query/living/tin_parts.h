// SPDX-License-Identifier: GPL-3.0-or-later
//
// A TIN of any size part by part: boxes of the grid at one level of detail, each within a memory
// limit. The parts agree on every triangle that meets both.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "engine/geometry/box.h"
#include "engine/memory_units.h"
#include "engine/mesh/tin.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/region.h"
#include "engine/query/shape/grid_cell.h"

namespace ptin {

/// What is asked of every part.
struct PartRequest {
  std::optional<Region> region;  ///< What to look at, map units; none: everything.
  DetailRequest detail;          ///< The TIN of which the parts are, the same for every region.
  QueryLimits limits{.memory_bytes = kMemoryOfParts};  ///< Limits of one part.
};

/// The parts of a TIN, one after the other. Threads: one owner.
class TinParts {
 public:
  /// @param terrain  A copy of it is kept, which shares the file.
  /// @throws Error as GridRegion and Detail
  /// Cost: that of Detail.
  TinParts(const OpenedTerrain& terrain, PartRequest request);
  ~TinParts();
  TinParts(TinParts&&) noexcept;
  TinParts& operator=(TinParts&&) noexcept;

  /// The triangles of the TIN that meet `box` (grid units, closed), all of those among them that
  /// meet the region. No neighbour is set: link_tin() (mesh/link.h) sets them. Valid until the next
  /// call. Null when they do not fit the limit.
  /// @throws Error corruption, io_error, cancelled
  /// Cost: as LivingTin::gather().
  [[nodiscard]] Tin* part(const GridBox& box);
  /// The part of a box that a cell needs. Null where the cell is to be cut into four.
  /// @throws Error resource_exhausted  the cell is a single position and its part does not fit
  ///               as part()
  [[nodiscard]] Tin* part_for(const GridCell& cell, const GridBox& box);

  /// Triangles of the whole TIN, about, by the table of errors: at most one bin of errors too many.
  [[nodiscard]] std::uint64_t triangles() const noexcept;
  [[nodiscard]] const OpenedTerrain& terrain() const noexcept;
  [[nodiscard]] const Detail& detail() const noexcept;
  [[nodiscard]] const PartRequest& request() const noexcept;
  /// What the parts so far cost, and Detail.
  [[nodiscard]] const QueryCost& cost() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Cuts the domain into cells that fit the memory limit and hands each, with its part, to `visit`
/// in the order of the Hilbert curve (hilbert_position()). Every vertex lies in exactly one cell. So
/// what is written cell by cell, in the order of the curve, does not depend on where the cuts are.
/// @param visit  Gets the cell, its part, and the share of the domain's area that is done after it.
/// @throws Error resource_exhausted  what a single position needs does not fit
///               as TinParts::part, and what `visit` throws
/// Cost: the parts; a triangle that meets several cells is gathered in each of them.
void walk_cells(TinParts& parts,
                const std::function<void(const GridCell& cell, Tin& part, double done)>& visit);

}  // namespace ptin
