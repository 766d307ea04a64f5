// SPDX-License-Identifier: GPL-3.0-or-later
//
// Line of sight (paper, section 5.3): coarse first, refined only where the answer is undecided.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include "engine/query/heights/locate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/sight/curvature.h"

namespace ptin {

/// Two ends in map units, and their heights (height's unit) above ground, or absolute.
struct SightPair {
  MapPoint a;
  double height_a = 0.0;
  MapPoint b;
  double height_b = 0.0;
};

struct SightRequest {
  bool absolute = false;  ///< Heights of the ends are absolute.
  Curvature curvature;
  /// Ground distance of two map positions in the height's unit (a geographic CRS: along the
  /// ellipsoid). None: the plane distance in map units.
  std::function<double(MapPoint, MapPoint)> ground_distance;
  double wavelength = 0.0;  ///< Height's unit; above 0 the first Fresnel zone is measured.
  /// What this level leaves out is left out of the search, but not below the ends, nor at a point
  /// that hides the line unless that point is a void.
  DetailRequest detail;
  /// Stop once this many records were retrieved for one pair: looked at before each step, so that
  /// the last one may overrun it.
  std::optional<std::uint64_t> budget;
  /// Nothing but the verdict is wanted: obstruction and clearance are what deciding it happened to
  /// show.
  bool verdict_only = false;
  QueryLimits limits;
};

/// Hidden: some inner point of the straight line (bent by curvature) lies strictly below the closed
/// surface. Touching is visible, voids do not obstruct. Undecided: the request stopped earlier, or
/// the file itself is not exact. Undefined: heights are above ground and an end stands on none. The
/// other three are certain, also of a request that leaves something out.
enum class SightVerdict : std::uint8_t { kVisible, kHidden, kUndecided, kUndefined };

/// A point of the line.
struct SightPoint {
  MapPoint position;      ///< Map units.
  double share = 0.0;     ///< Of the way from a to b.
  double distance = 0.0;  ///< From a over ground, height's unit.
  double height = 0.0;    ///< Of the line there, height's unit.
};

struct SightResult {
  SightVerdict verdict = SightVerdict::kUndecided;
  /// Exact, unless the budget ended before them.
  PointState state_a = PointState::kOutside, state_b = PointState::kOutside;
  double length = 0.0;  ///< Over ground, height's unit.
  /// Hidden: where the line first goes below ground (with `verdict_only`, or not exact: some point
  /// where it is below).
  std::optional<SightPoint> obstruction;
  /// Smallest height of the line above the surface, ends included, and where: the truth lies in
  /// [clearance_min, clearance_max], equal when exact; the larger is infinite when all there is may
  /// be void. NaN where there is no surface.
  double clearance_min = std::numeric_limits<double>::quiet_NaN();
  double clearance_max = std::numeric_limits<double>::quiet_NaN();
  std::optional<SightPoint> clearance_at;
  /// Smallest clearance over the radius of the first Fresnel zone, ends excluded; none when the
  /// budget ended before. At a tolerance that of the coarser surface.
  std::optional<double> fresnel_ratio;
  std::optional<SightPoint> fresnel_at;
  /// Length of the line over voids, height's unit; NaN when not known (`verdict_only`, or records
  /// left out that decide it).
  double void_length = std::numeric_limits<double>::quiet_NaN();
  double certified_deviation = 0.0;  ///< Of what is undecided; 0 when nothing is.
  bool exact = false;                ///< All that is told is true of the source.
  QueryCost cost;
};

/// Answers pairs one after the other over one mesh: a coarse one of the whole terrain, in which
/// most lines are decided, and what single lines had refined, until it grows too large.
///
/// The path is straight in the file's CRS and distances are proportional along it (geographic CRS:
/// to a thousandth at 100 km and middle latitudes). Threads: one owner; several solvers may work
/// over one terrain.
class SightSolver {
 public:
  /// @param terrain       Borrowed for the life of the solver.
  /// @param base_records  Records of the coarse mesh: more decides more lines without reading, but
  ///                      each walks farther. 0: none, best for one pair.
  /// @throws Error invalid_argument (as Detail too), resource_exhausted, corruption, io_error,
  /// cancelled
  SightSolver(const OpenedTerrain& terrain, SightRequest request,
              std::uint64_t base_records = std::uint64_t{1} << 15);
  ~SightSolver();
  SightSolver(SightSolver&&) noexcept;
  SightSolver& operator=(SightSolver&&) noexcept;

  /// Cost of the coarse mesh, and of finding the last of `vertices`; not part of any result's.
  [[nodiscard]] const QueryCost& base_cost() const noexcept;

  /// @throws Error invalid_argument (a number is not finite, a height beyond 1e30, a position more
  /// than 2^31 grid units away), resource_exhausted, corruption, io_error, cancelled
  [[nodiscard]] SightResult solve(const SightPair& pair);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// One pair; its cost is all of it.  @throws Error as SightSolver
[[nodiscard]] SightResult sight(const OpenedTerrain& terrain, const SightPair& pair,
                                const SightRequest& request = {});

}  // namespace ptin
