// SPDX-License-Identifier: GPL-3.0-or-later
//
// From the coordinates of points, read once, to the grid that keeps their digits.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/geometry/affine.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Whole steps of a coordinate: exactly, in units of 10^-decimals, or rounded to the nearest
/// multiple of a unit from an origin.
class StepCounter {
 public:
  StepCounter() = default;
  explicit StepCounter(int decimals) : decimals_(decimals) {}
  StepCounter(double unit, double origin) : unit_(unit), origin_(origin) {}

  /// Beyond 2^62 in either direction is given as that: far beyond the grid. Monotone.
  [[nodiscard]] std::int64_t steps(Decimal value) const noexcept;
  [[nodiscard]] double unit() const noexcept;
  /// The coordinate at a number of steps.
  [[nodiscard]] double coordinate(std::int64_t steps) const noexcept;
  /// How far from its place in the source a coordinate stands on the grid.
  [[nodiscard]] double shift(Decimal value) const noexcept {
    return unit_ > 0.0 ? distance(value) : 0.0;
  }
  [[nodiscard]] bool is_exact() const noexcept { return unit_ == 0.0; }

 private:
  [[nodiscard]] double distance(Decimal value) const noexcept;
  int decimals_ = 0;
  double unit_ = 0.0;  ///< 0: decimals.
  double origin_ = 0.0;
};

/// Smallest and largest of many decimals, exactly, and the most digits that one of them has.
class DecimalRange {
 public:
  void add(Decimal d) noexcept {
    Extreme& e = extremes_[static_cast<std::size_t>(d.decimals)];
    e.low = d.mantissa < e.low ? d.mantissa : e.low;
    e.high = d.mantissa > e.high ? d.mantissa : e.high;
  }
  [[nodiscard]] int decimals() const noexcept;
  /// Steps of the smallest and of the largest one. REQUIRES: some were added.
  [[nodiscard]] std::int64_t lowest(const StepCounter& counter) const noexcept;
  [[nodiscard]] std::int64_t highest(const StepCounter& counter) const noexcept;

 private:
  struct Extreme {
    std::int64_t low = INT64_MAX, high = INT64_MIN;
  };
  std::array<Extreme, 19> extremes_;  ///< By decimals.
};

/// Where points go.
struct PointGrid {
  StepCounter x, y;
  std::int64_t west = 0, south = 0;  ///< Steps of the grid's origin.
  std::int64_t east = 0, north = 0;  ///< Steps of the farthest points.
  StepCounter heights;               ///< Whole codes, where `whole`.
  bool whole = false;  ///< Heights are codes: whole steps of a power of ten that fit int32.

  [[nodiscard]] GridPoint position(const SourcePoint& p) const noexcept {
    return {static_cast<std::int32_t>(x.steps(p.x) - west),
            static_cast<std::int32_t>(y.steps(p.y) - south)};
  }
  /// The height as merging takes it: its code where `whole`, else in its unit.
  [[nodiscard]] double height(Decimal z) const noexcept {
    return whole ? static_cast<double>(heights.steps(z)) : to_double(z);
  }
  /// The largest x or y of all points, on the grid.
  [[nodiscard]] std::int64_t largest() const noexcept {
    return east - west > north - south ? east - west : north - south;
  }
  /// How far in plan a point moves, CRS units.
  [[nodiscard]] double shift(const SourcePoint& p) const noexcept;
  [[nodiscard]] AffineMap map() const noexcept;
};

/// Sees every point once, then knows the grid: PointBuckets::read() says which.
class PointGridScan {
 public:
  /// @throws Error invalid_argument  a resolution that is no length
  PointGridScan(std::optional<double> resolution, const std::string& context);

  /// Once for each file, before its points.
  void add_source(const PointStreamFacts& facts);
  void add(const SourcePoint& p) noexcept {
    ++points_;
    x_.add(p.x);
    y_.add(p.y);
    z_.add(p.z);
  }
  [[nodiscard]] std::uint64_t points() const noexcept { return points_; }
  /// REQUIRES: there are points.
  /// @throws Error invalid_argument  an extent of more than 2^30 steps
  [[nodiscard]] PointGrid grid() const;

 private:
  void choose_steps(PointGrid& grid) const;

  std::optional<double> resolution_;
  std::string context_;
  std::optional<SourceLattice> lattice_;
  int plan_decimals_ = 0, height_decimals_ = 0;
  DecimalRange x_, y_, z_;
  std::uint64_t points_ = 0;
};

/// True when a point's height and place are wanted: no `nodata`, and inside of the bounds.
[[nodiscard]] bool is_wanted(const SourcePoint& p, const SourceOptions& options) noexcept;

}  // namespace ptin
