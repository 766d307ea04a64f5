// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lines of sight: only what may decide the answer is looked at.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "engine/query/heights/locate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/sight/curvature.h"

namespace ptin {

/// Two ends in map units, and their heights (height's unit) above ground, or absolute
/// (SightRequest::absolute).
struct SightPair {
  MapPoint a;
  double height_a = 0.0;
  MapPoint b;
  double height_b = 0.0;
};

struct SightRequest {
  bool absolute = false;  ///< Heights of the ends are absolute, not above ground.
  Curvature curvature;
  /// Ground distance of two map positions in the height's unit (a geographic CRS: along the
  /// ellipsoid). None: the plane distance in map units.
  std::function<double(MapPoint, MapPoint)> ground_distance;
  double wavelength = 0.0;  ///< Height's unit; above 0 the first Fresnel zone is measured.
  /// What this level leaves out is not read, with these exceptions. The ground below the ends is exact
  /// all the same. Where a single point hides the line unless it is a void, the surface at that point
  /// is exact. And so it is in a few points more (not as the paper has it), by which the answer is
  /// most open.
  DetailRequest detail;
  /// Stop once so many stars were read for one pair; of the full TIN of a raster samples, and as the
  /// paper has it records. Checked before each step, so the last step may overrun it: by a tile of
  /// samples, say.
  std::optional<std::uint64_t> budget;
  /// Only the verdict is wanted. The obstruction is then any point below ground that deciding
  /// showed, and clearances are NaN unless both ends have one position.
  bool verdict_only = false;
  QueryLimits limits;
};

/// Hidden: some inner point of the straight line (bent by curvature) lies strictly below the closed
/// surface. Touching is visible, and voids do not obstruct. Undefined: heights are above ground,
/// and an end stands on no ground. Undecided: the level of detail or the budget left out what
/// decides, or the file itself is not exact. Visible, hidden and undefined are certain, also for a
/// request that leaves records out.
enum class SightVerdict : std::uint8_t { kVisible, kHidden, kUndecided, kUndefined };

/// A point of the line.
struct SightPoint {
  MapPoint position;      ///< Map units.
  double share = 0.0;     ///< Share of the way from a to b.
  double distance = 0.0;  ///< From a over ground, height's unit.
  double height = 0.0;    ///< Height of the line there, height's unit.
};

struct SightResult {
  SightVerdict verdict = SightVerdict::kUndecided;
  /// What the ends stand on. Exact, unless the budget ended before they were known.
  PointState state_a = PointState::kOutside, state_b = PointState::kOutside;
  double length = 0.0;  ///< Length of the line over ground, height's unit.
  /// Set when hidden: where the line first goes below ground. With `verdict_only`, or when not
  /// exact, some point where it is below ground.
  std::optional<SightPoint> obstruction;
  /// Smallest height of the line above the surface, ends included, height's unit: the true one lies
  /// in [clearance_min, clearance_max], which are equal when exact. clearance_max is infinite when
  /// everything below the line may be void. NaN where no surface is below the line.
  double clearance_min = std::numeric_limits<double>::quiet_NaN();
  double clearance_max = std::numeric_limits<double>::quiet_NaN();
  std::optional<SightPoint> clearance_at;  ///< Where the clearance is smallest.
  /// Smallest ratio of clearance to the radius of the first Fresnel zone, ends excluded; none when
  /// the budget ended before the whole line was known. At a level of detail that of the coarser
  /// surface.
  std::optional<double> fresnel_ratio;
  std::optional<SightPoint> fresnel_at;
  /// Length of the line over voids, height's unit. NaN when not known: with `verdict_only`, or when
  /// records left out may change it.
  double void_length = std::numeric_limits<double>::quiet_NaN();
  /// Most that the surface may deviate where the line is undecided; 0 when it is decided, infinite
  /// where the budget left the line unread.
  double certified_deviation = 0.0;
  bool exact = false;  ///< All that the result says holds of the source.
  QueryCost cost;
};

class QueryContext;
class SightLine;
class SightSearch;
struct SightFacts;

/// Another way to answer than by the triangles that live at a level (paper/visibility.h).
struct SightWay {
  /// Begins the search for what one line needs; all is borrowed.
  std::unique_ptr<SightSearch> (*search)(const OpenedTerrain&, const SightFacts&,
                                         const SightRequest&, const SightLine&, QueryContext&);
  /// The ground at a point, of an upright line.
  LocateResult (*locate)(const OpenedTerrain&, std::span<const MapPoint>, const LocateRequest&);
};

/// Answers pairs one after the other. It keeps a coarse level of the whole terrain in memory: where
/// no full surface can lie so low that the line passes above it, a verdict reads nothing, and
/// elsewhere the level says where to look first.
///
/// The path is straight in the file's CRS, and distances are proportional along it. (In a
/// geographic CRS that is true to a thousandth at 100 km and middle latitudes.) Threads: one owner;
/// several solvers may work over one terrain.
class SightSolver {
 public:
  static constexpr std::uint64_t kCoarseRecords = std::uint64_t{1} << 14;

  /// @param terrain         A copy of it is kept, which shares the file.
  /// @param coarse_records  About how many records make the coarse level. More of them decide more
  ///                        lines without reading, but are read first. 0: none, best for few pairs.
  /// @throws Error invalid_argument (as Detail too), resource_exhausted, corruption, io_error,
  /// cancelled
  SightSolver(const OpenedTerrain& terrain, SightRequest request,
              std::uint64_t coarse_records = kCoarseRecords);
  /// The same in another way, without a coarse level.
  SightSolver(const OpenedTerrain& terrain, SightRequest request, SightWay way);
  ~SightSolver();
  SightSolver(SightSolver&&) noexcept;
  SightSolver& operator=(SightSolver&&) noexcept;

  /// Cost of the coarse level, and of finding the last of `vertices`; no result's cost includes it.
  [[nodiscard]] const QueryCost& base_cost() const noexcept;

  /// Answers one pair. After an error the solver can be asked again.
  /// @throws Error invalid_argument (a number is not finite, a height beyond 1e30, a position more
  /// than 2^31 grid units away), resource_exhausted, corruption, io_error, cancelled
  [[nodiscard]] SightResult solve(const SightPair& pair);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ptin
