// SPDX-License-Identifier: GPL-3.0-or-later
//
// Selective refinement (paper, section 4): the TIN at a level of detail, in a region.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/query_limits.h"

namespace ptin {

/// Whether the result covers the whole domain (coarse outside of the region) or keeps the triangles
/// that meet the region.
enum class ResultForm { kWholeDomain, kMeetingRegion };

struct RefineRequest {
  /// Where to refine: a window, point, segment or polygon in map units (select/region.h). None
  /// means everywhere.
  std::optional<Region> region;
  /// A tolerance of 0 means every sample exact: flat and coplanar parts stay coarse.
  /// A number of vertices is here that of the mesh, T0 and vertices without a height included. It
  /// is reached exactly: with a region by the most important records of the region. A number above
  /// all there are gives all of them. Vertices are counted before kMeetingRegion drops the
  /// triangles outside of the region.
  DetailRequest detail;
  /// The TIN of the most important vertices that has at most this many triangles, T0's and void ones
  /// included, counted as vertices are. It has as many, or one less where the next vertex adds two;
  /// fewer only where there are no more. At least as many as T0 has. Excludes tolerance and number
  /// of vertices.
  std::optional<std::uint64_t> triangles;
  /// A further monotone predicate, intersected with region and tolerance; null: none. Borrowed for
  /// the call.
  const AttributePredicate* also = nullptr;
  ResultForm form = ResultForm::kWholeDomain;  ///< Without a region both forms are the same.
  bool page_of_triangle = false;               ///< Fill RefinedTin::page_of_triangle.
  QueryLimits limits;
};

/// A refined TIN. Positions are grid positions and heights are stored ones; `map` and `heights` of
/// the store's facts turn them into map units and heights.
struct RefinedTin {
  Tin tin;  ///< Compact: every vertex and triangle is alive (kMeetingRegion: renumbered).
  /// Filled on request: for each triangle the page of the record that made it, or kNone for T0.
  std::vector<std::uint32_t> page_of_triangle;
  std::uint64_t vertices = 0;  ///< Vertices of the mesh, those without a height included.
  std::uint64_t void_vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t t0_vertices = 0;
  /// Bound of the error at every sample in the region (everywhere when there is none), height's
  /// unit; at least base_error.
  double certified_error = 0.0;
  double certified_deviation = 0.0;  ///< Bound of the deviation at any point, likewise.
  /// Every triangle that meets the region is one of the full TIN, and base_error is 0.
  bool exact = false;
  QueryCost cost;
};

/// Refines T0: retrieves the records for which the request's predicate is true, orders them
/// (refine/apply_order.h) and applies them. Exact (P1), certified (P2), valid (P3), closed and lean
/// (P4), joined (P5).
/// @throws Error invalid_argument    tolerance negative or NaN; `vertices` or `triangles` below those
///                                   of T0; two of the three given; region not finite
///               resource_exhausted  the index says that the answer exceeds the memory limit; names
///                                   `export`
///               corruption, io_error, cancelled
/// Cost: O(|T0| + k) time and memory for k records retrieved; usually O(k / B + log_B n) index
/// pages, B entries a page.
[[nodiscard]] RefinedTin refine(const OpenedTerrain& terrain, const RefineRequest& request);

}  // namespace ptin
