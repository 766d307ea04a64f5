// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isolines of a terrain: joined polylines and rings, at full detail, at a
// certified error or of the first vertices, of any size within a memory limit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/query/isoline/isoline_pieces.h"
#include "engine/query/isoline/levels.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/select/region.h"

namespace ptin {

struct IsolineRequest {
  std::vector<double> levels;  ///< Height's unit, in any order; repetitions are dropped.
  /// A window or a polygon, map units; lines are cut at its border. None: everywhere.
  std::optional<Region> region;
  /// Off: lines go on to the last triangle that meets the region. Segments are whole then, so that
  /// what lies across two regions has the same ends in both.
  bool cuts = true;
  DetailRequest detail;                   ///< The TIN of which the isolines are.
  std::uint64_t most_lines = 10'000'000;  ///< More lines than this are refused.
  QueryLimits limits;
  /// Folder of a temporary file for points that do not fit the memory. Empty: no such file, and an
  /// extraction that needs one fails (resource_exhausted).
  std::string temporary_folder;
  bool counts_vertices = false;  ///< Fill in TraceCounts::vertices: a look-up for each corner.
  int threads = 1;  ///< At most; fewer where the memory is small. The lines do not depend on it.
};

/// A line to be read. `points` are in map units, without repetitions in a row, and lie in the
/// vector that was given to Isolines::line().
struct Isoline {
  std::uint32_t level = 0;  ///< Index into Isolines::levels().
  bool ring = false;        ///< The last point is the first one again.
  std::span<const MapPoint> points;
};

/// The isolines of a request. Higher ground lies to the right of each.
///
/// Laws. Lines of one TIN never cross; they share a point only at a vertex exactly at their level.
/// A line ends on the border of the surface (at the domain's border or a void) or of the region. A
/// ridge exactly at a level, lower on both sides, is gone round: there and back. A peak exactly at
/// a level gives no line. Lines and their order do not depend on memory limit or tiles. The lines
/// of any region are those of the whole terrain, cut: a cut is computed from the ends of the
/// segment it cuts.
/// Threads: const functions may be called at once.
class Isolines {
 public:
  [[nodiscard]] const std::vector<double>& levels() const noexcept { return levels_; }
  [[nodiscard]] std::size_t size() const noexcept { return lines_.lines.size(); }
  /// Line `i`; lines are ordered by level.
  /// @param points  Filled with the points of the line, to which the result refers.
  /// @throws Error io_error  when its points are in a temporary file that cannot be read
  [[nodiscard]] Isoline line(std::size_t i, std::vector<MapPoint>& points) const;
  [[nodiscard]] std::uint64_t points() const noexcept { return points_.size(); }

  QueryCost cost;
  TraceCounts crossed;      ///< What the levels cross, over all tiles.
  std::uint64_t tiles = 0;  ///< Parts in which the terrain was processed.
  /// Certificate of the TIN whose isolines these are, height's unit.
  double certified_error = 0.0;
  double certified_deviation = 0.0;
  bool exact = false;  ///< Nothing was left out, and the file's base error is 0.

 private:
  friend class IsolineExtraction;
  friend class ProgressiveIsolines;
  explicit Isolines(PointStore points) : points_(std::move(points)) {}
  std::vector<double> levels_;
  JoinedLines lines_;
  std::vector<IsolinePiece> pieces_;
  PointStore points_;
};

/// Extracts isolines, all levels together. The terrain is processed in tiles that fit the memory;
/// lines are joined exactly across tiles.
/// @throws Error invalid_argument    levels, region or tolerance mean nothing, or the region has no
///                                   inside; as Detail
///               resource_exhausted  more than most_lines lines, told before any is handed out; a
///                                   tile that cannot be made small enough; no room for points
///               corruption, io_error, cancelled
/// Cost: the stars whose heights hold a level; O(n log n) in the lines. With `vertices` the cost of
/// Detail is added (select/detail.h).
[[nodiscard]] Isolines isolines(const OpenedTerrain& terrain, const IsolineRequest& request);

}  // namespace ptin
