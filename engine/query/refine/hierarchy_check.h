// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the records of a file are what every question stands on: a hierarchy that is closed and
// saturated (engine/DESIGN.md, sections 2.2 and 2.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/memory_units.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "storage/verify.h"

namespace ptin {

struct HierarchyRequest {
  /// Memory of one cell: records, mesh and what is noted beside them. A file of any size is checked
  /// in as many cells as that takes; they are of about 64 MiB where that is less, since the mesh
  /// then stays in the caches.
  QueryLimits limits{.memory_bytes = kMemoryOfParts};
  /// The check ends when one fault more than this is found.
  std::size_t max_faults = 100;
  /// Called after each cell: the share of the terrain's area that is done.
  std::function<void(double done)> progress;
};

struct HierarchyReport {
  std::vector<VerifyFault> faults;  ///< Each names page and vertex of a record.
  bool stopped_early = false;       ///< max_faults was reached.
  std::uint64_t cells = 0;          ///< Parts of the terrain in which splits were applied.
  std::uint64_t records = 0;        ///< Records held against what they need, each once.

  [[nodiscard]] bool is_sound() const noexcept { return faults.empty(); }
};

/// Applies every record by falling rank, cell by cell, and looks at each whether
/// - it finds its w, vl, vr and fan;
/// - of each record that it needs, roi and heights hold its own, error and deviation are at least
///   its own, and the rank is above its own;
/// - its star, as the page has it, is the one that its split makes. So what every reader of stars
///   sees to is true of the split: its triangles are counter-clockwise and of classes that fit its
///   heights, its roi holds P(u), its interval of heights those of u and of the corners of P(u);
/// - the triangles of its fan die at its error, by the stars and T0 that hold them; and no others
///   die.
/// The mesh of each cell is validated (mesh/validate.h), and held against the heights of the raster where
/// the file has them (floor_check.h). Where no fault is found, the theorem of
/// engine/DESIGN.md, section 2.4, holds for the file, and that of section 2.10, so that no question
/// meets a record that does not fit, and answers by stars are those by splits. What only the source
/// can show is not looked at: whether errors and deviations are large enough.
///
/// Attributes are looked at in the cell that holds w. That suffices (by induction over the order of
/// falling rank): let the records before b be without fault. They are saturated, so those whose roi
/// meets a cell are closed, and their mesh agrees with the mesh of all of them on every triangle
/// that meets the cell (P1). All triangles of b's fan have the corner w, and the roi of b holds w
/// (as every reader of records checks). So in the cell of w b is applied to the very fan that it
/// has among all records.
///
/// @param terrain  Verified by verify_store(): what that finds is not looked for again.
/// @throws Error resource_exhausted  what a single position needs does not fit the limit
///               io_error, cancelled
/// Cost: about that of a refinement of everything; a record is applied in each cell that its roi
/// meets.
[[nodiscard]] HierarchyReport check_hierarchy(const OpenedTerrain& terrain,
                                              const HierarchyRequest& request = {});

}  // namespace ptin
