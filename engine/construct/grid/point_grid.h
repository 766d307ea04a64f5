// SPDX-License-Identifier: GPL-3.0-or-later
//
// The grid that keeps the digits of all points, found in one pass over them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "engine/construct/grid/far_points.h"
#include "engine/construct/grid/left_out.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/terrain_frame.h"
#include "engine/geometry/affine.h"
#include "engine/geometry/point.h"

namespace ptin {

/// Turns coordinates into whole numbers of steps, and back.
class StepCounter {
 public:
  StepCounter() = default;
  /// Steps of 10^-decimals from 0, counted exactly; a value with more decimals is rounded to the
  /// nearest.
  explicit StepCounter(int decimals) : decimals_(decimals) {}
  /// Steps of `unit` from `origin`; coordinates are rounded to the nearest. REQUIRES: unit > 0.
  StepCounter(double unit, double origin) : unit_(unit), origin_(origin) {}

  /// The steps of `value`. Numbers far beyond the grid are given as 2^62 or -2^62. Monotone.
  [[nodiscard]] std::int64_t steps(Decimal value) const noexcept;
  /// The length of a step.
  [[nodiscard]] double unit() const noexcept;
  /// The coordinate at a number of steps.
  [[nodiscard]] double coordinate(std::int64_t steps) const noexcept;
  /// `value` less the coordinate of its step. Where steps are counted exactly it is off by what 64 bits
  /// of both lack.
  [[nodiscard]] double rest(Decimal value) const noexcept;
  /// How far rounding to a step moves `value`.
  [[nodiscard]] double shift(Decimal value) const noexcept { return std::abs(rest(value)); }
  [[nodiscard]] bool is_exact() const noexcept { return unit_ == 0.0; }

 private:
  int decimals_ = 0;
  [[maybe_unused]] int unused_ = 0;  ///< In the place of padding: grids are written as they are.
  double unit_ = 0.0;                ///< 0: steps are 10^-decimals_, counted exactly.
  double origin_ = 0.0;
};

/// The smallest and the largest of many decimals, exactly, and the most digits after the point that
/// one of them has, as it is or rounded.
class DecimalRange {
 public:
  void add(Decimal d) noexcept {
    Extreme& e = extremes_[static_cast<std::size_t>(d.decimals)];
    e.low = d.mantissa < e.low ? d.mantissa : e.low;
    e.high = d.mantissa > e.high ? d.mantissa : e.high;
    if ((unsettled_ & ((1U << static_cast<unsigned>(d.decimals)) - 1U)) != 0U) {
      round(d);
    }
  }
  /// Adds what another range has seen.
  void join(const DecimalRange& other) noexcept;
  /// The most digits after the point; 0 when nothing was added.
  [[nodiscard]] int decimals() const noexcept;
  /// The most that stay when each is rounded to at most so many, and loses the zeros at its end.
  [[nodiscard]] int decimals_rounded_to(int decimals) const noexcept;
  /// The steps of the smallest decimal; INT64_MAX where none was added.
  [[nodiscard]] std::int64_t lowest(const StepCounter& counter) const noexcept {
    return in_steps(counter).low;
  }
  /// The steps of the largest decimal; INT64_MIN where none was added.
  [[nodiscard]] std::int64_t highest(const StepCounter& counter) const noexcept {
    return in_steps(counter).high;
  }

 private:
  struct Extreme {
    std::int64_t low = INT64_MAX, high = INT64_MIN;
  };
  [[nodiscard]] Extreme in_steps(const StepCounter& counter) const noexcept;
  void round(Decimal d) noexcept;
  std::array<Extreme, 19> extremes_;  ///< By decimals: only such mantissas can be compared.
  /// By decimals to round to: the most that stay of those that have more.
  std::array<std::uint32_t, 19> rounded_{};
  /// Bit `d`: d decimals are more than rounding to d left so far. The first few values of most
  /// sources settle it, so that adding others costs no rounding.
  std::uint32_t unsettled_ = 0x7fffe;
};

/// The grid of points, and how their heights are held until the encoding is known.
struct PointGrid {
  StepCounter x, y;
  std::int64_t west = 0, south = 0;  ///< Steps of the smallest x and y: the grid's origin.
  std::int64_t east = 0, north = 0;  ///< Steps of the largest x and y.
  StepCounter heights;               ///< Turns heights into codes, where `whole`.
  bool whole = false;  ///< Heights are codes: whole steps of a power of ten, which fit int32.
  bool drops_digits = false;  ///< Digits of x and y, which then move to the nearest step.
  /// The points take more than 180 units from west to east, and as many on end are empty.
  bool is_split = false;
  std::array<bool, 5> unused{};  ///< In the place of padding: grids are written as they are.

  /// REQUIRES: `p` is one of the points from which the grid was found.
  [[nodiscard]] GridPoint position(const SourcePoint& p) const noexcept {
    return {static_cast<std::int32_t>(x.steps(p.x) - west),
            static_cast<std::int32_t>(y.steps(p.y) - south)};
  }
  /// How far a vertex of a line moves in plan, whose digits the grid may not have; CRS units.
  [[nodiscard]] double shift_of_line(const SourcePoint& p) const noexcept;
  /// The height of a point until it is encoded: its code where `whole`, else the height itself.
  [[nodiscard]] double height(Decimal z) const noexcept {
    return whole ? static_cast<double>(heights.steps(z)) : to_double(z);
  }
  /// The largest x or y of all points, in grid units.
  [[nodiscard]] std::int64_t largest() const noexcept {
    return east - west > north - south ? east - west : north - south;
  }
  /// How far a point moves in plan when it is put on the grid, CRS units.
  [[nodiscard]] double shift(const SourcePoint& p) const noexcept;
  /// From the grid to the CRS.
  [[nodiscard]] AffineMap map() const noexcept;
};

/// Which whole units from -360 to 540 hold a value. A plain value.
class UnitsTaken {
 public:
  void add(double value) noexcept {
    if (value >= kFirst && value < kLast) {
      const auto unit = static_cast<std::size_t>(value - kFirst);
      bits_[unit / 64] |= std::uint64_t{1} << (unit % 64);
    }
  }
  void join(const UnitsTaken& other) noexcept;
  /// True when values lie more than 180 units apart, and at least 180 units on end hold none.
  [[nodiscard]] bool are_split() const noexcept;

 private:
  static constexpr double kFirst = -360.0, kLast = 540.0;
  std::array<std::uint64_t, 15> bits_{};
};

/// What is known of many points together. A plain value.
struct PointExtent {
  DecimalRange x, y, z;
  std::uint64_t points = 0;
  FarPoints far;
  UnitsTaken longitudes;  ///< Should the CRS have degrees.

  void add(const SourcePoint& p) noexcept {
    ++points;
    x.add(p.x);
    y.add(p.y);
    z.add(p.z);
    const double east = to_double(p.x);
    far.add(east, to_double(p.y), to_double(p.z));
    longitudes.add(east);
  }
  /// Adds what another one has seen.
  void join(const PointExtent& other) noexcept;
};

/// Sees every point of all sources once, then gives their grid. PointBuckets::read() says by which
/// rules (points/point_buckets.h).
class PointGridScan {
 public:
  /// @param resolution  The grid unit in CRS units; none: the unit that keeps every digit.
  /// @param context     The path of the first source, for errors.
  /// @throws Error invalid_argument  the resolution is not finite, or not above 0
  PointGridScan(std::optional<double> resolution, const std::string& context);

  /// To be called once for each file, before its points are added.
  void add_source(const PointStreamFacts& facts);
  void add(const SourcePoint& p) noexcept { extent_.add(p); }
  /// Adds points that were seen elsewhere.
  void add(const PointExtent& points) noexcept { extent_.join(points); }
  /// Vertices of lines extend the grid. Their digits count as those of points do, up to two after the
  /// point, or seven in degrees; more are kept where points have more.
  void add_line_vertex(const SourcePoint& v, bool has_height, bool degrees) noexcept;
  [[nodiscard]] std::uint64_t points() const noexcept { return extent_.points; }
  /// Warnings of points that lie far from all others.
  /// @param files         As FarPoints::warnings().
  /// @param are_vertices  They are those of a TIN.
  [[nodiscard]] SourceWarnings warnings(const std::vector<std::string>& files,
                                        bool are_vertices) const {
    return extent_.far.warnings(extent_.points, files, are_vertices);
  }
  /// True when the boxes of all points and of all vertices of lines so far have nothing in common.
  [[nodiscard]] bool lines_are_elsewhere() const noexcept;
  /// Digits that 2^30 steps do not keep, or doubles do not, are dropped, half away from zero, and so is
  /// a lattice. Digits of computed numbers often leave round ones then, whose steps are longer.
  /// REQUIRES: there are points.
  /// @throws Error invalid_argument  an extent of more than 2^30 steps of the chosen resolution, or of
  ///                                 one unit
  [[nodiscard]] PointGrid grid() const;

 private:
  void choose_steps(PointGrid& grid) const;
  void set_bounds(PointGrid& grid) const;
  [[nodiscard]] bool fits(PointGrid& grid) const;

  std::optional<double> resolution_;
  std::string context_;
  std::optional<SourceLattice> lattice_;  ///< The finest one.
  bool has_sources_ = false;
  bool is_common_ = true;  ///< All sources lie on one lattice.
  int plan_decimals_ = 0, height_decimals_ = 0;
  PointExtent extent_;
  DecimalRange line_x_, line_y_, line_z_;
  int most_line_decimals_ = 0;  ///< So many decimals of a line's x and y count.
};

/// Why a point is not to be built from: its height is `options.nodata`, or it lies outside of
/// `options.bbox`, which is closed. None where it is.
[[nodiscard]] std::optional<LeftOutReason> why_left_out(const SourcePoint& p,
                                                        const SourceOptions& options) noexcept;

}  // namespace ptin
