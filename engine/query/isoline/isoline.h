// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of a terrain: joined polylines and rings (paper, section 5.2), at full detail, at a
// certified error or of the first vertices, of any size within a memory limit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/isoline_trace.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/select/region.h"

namespace ptin {

struct IsolineRequest {
  std::vector<double> levels;    ///< Height's unit; sorted, and repetitions dropped (levels.h).
  std::optional<Window> window;  ///< Map units; lines are cut at its border. None: everywhere.
  DetailRequest detail;          ///< Of which TIN the isolines are.
  std::uint64_t most_lines = 10'000'000;
  QueryLimits limits;
  /// Where points go that do not fit the memory. Empty: nowhere, and the extraction fails then.
  std::string temporary_folder;
  int threads = 1;  ///< At most; fewer where the memory is small. The lines are the same.
};

/// A line to be read: `points` are in map units, without repetitions in a row.
struct Isoline {
  std::uint32_t level = 0;  ///< Index into Isolines::levels().
  bool ring = false;        ///< The last point is the first one again.
  std::span<const MapPoint> points;
};

/// The isolines of a request. Higher ground lies to the right of each.
///
/// Laws: lines of one TIN never cross; they share a point only at a vertex exactly at their level.
/// A line's ends lie on the border of the surface (domain or void) or of the window. A ridge
/// exactly at a level, lower on both sides, is gone round: there and back. A peak exactly at a
/// level gives nothing. Lines and their order do not depend on memory limit or tiles; a window's
/// lines are those of the whole terrain, cut, whichever window: a cut is computed from the ends of
/// the segment it cuts.
/// Threads: const functions may be called at once.
class Isolines {
 public:
  [[nodiscard]] const std::vector<double>& levels() const noexcept { return levels_; }
  [[nodiscard]] std::size_t size() const noexcept { return lines_.lines.size(); }
  /// Line `i`. Ordered by level. @param points  Holds the points of the result.
  /// @throws Error io_error  when its points are in a temporary file that cannot be read
  [[nodiscard]] Isoline line(std::size_t i, std::vector<MapPoint>& points) const;
  [[nodiscard]] std::uint64_t points() const noexcept { return points_.size(); }

  QueryCost cost;
  TraceCounts crossed;
  std::uint64_t tiles = 0;       ///< Parts in which the terrain was processed.
  double certified_error = 0.0;  ///< Of the TIN whose isolines these are.
  double certified_deviation = 0.0;
  bool exact = false;

 private:
  friend class IsolineExtraction;
  friend class ProgressiveIsolines;
  explicit Isolines(PointStore points) : points_(std::move(points)) {}
  std::vector<double> levels_;
  JoinedLines lines_;
  std::vector<IsolinePiece> pieces_;
  PointStore points_;
};

/// Extracts isolines. All levels share one refinement. The terrain is processed in tiles that fit
/// the memory, known from the index before their pages are read; lines are joined exactly across
/// them.
/// @throws Error invalid_argument    levels, window or tolerance mean nothing; as Detail
///               resource_exhausted  more than most_lines lines, told before any is handed out; a
///                                   tile that cannot be made small enough; no room for points
///               corruption, io_error, cancelled
/// Cost: records whose height interval holds a level; O(n log n) in the lines. With `vertices` that
/// of finding the last one is added (detail.h).
[[nodiscard]] Isolines isolines(const OpenedTerrain& terrain, const IsolineRequest& request);

}  // namespace ptin
