// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/point_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/construct/grid/grid_precision.h"
#include "engine/construct/grid/height_fit.h"
#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/error.h"

namespace ptin {
namespace {

__extension__ using Int128 = __int128;

// Lines are often computed, with more digits than anybody measured: a hundredth of a unit, or in
// degrees a centimetre, is what is kept of them in any case.
constexpr int kMostLineDecimals = 2;
constexpr int kMostDegreeDecimals = 7;

/// Refuses an extent beyond the grid, and names the power of ten that would do.
void check_extent(double extent, double unit, const std::string& context) {
  if (extent / unit <= kGridMax) {
    return;
  }
  const double enough = std::pow(10.0, std::ceil(std::log10(extent / kGridMax)));
  char text[200];
  std::snprintf(text, sizeof text,
                "the points span %.9g units in steps of %g: more than the 2^30 steps of the grid; "
                "give a coarser resolution, such as %g",
                extent, unit, enough);
  throw Error(ErrorCode::invalid_argument, text, context);
}

}  // namespace

std::int64_t StepCounter::steps(Decimal value) const noexcept {
  static constexpr std::int64_t kFar = std::int64_t{1} << 62;
  if (unit_ > 0.0) {
    const double steps = std::round((to_double(value) - origin_) / unit_);
    return std::abs(steps) < 9007199254740992.0 ? static_cast<std::int64_t>(steps)
                                                : (steps < 0 ? -kFar : kFar);
  }
  if (value.decimals == decimals_) {
    return value.mantissa;
  }
  if (value.decimals > decimals_) {  // ties away from zero
    const std::int64_t step = power_of_ten(value.decimals - decimals_);
    const std::int64_t rest = value.mantissa % step;
    return value.mantissa / step + (rest >= step - rest ? 1 : (-rest >= step + rest ? -1 : 0));
  }
  const Int128 steps = Int128{value.mantissa} * power_of_ten(decimals_ - value.decimals);
  return static_cast<std::int64_t>(std::clamp<Int128>(steps, -kFar, kFar));
}

double StepCounter::unit() const noexcept { return unit_ > 0.0 ? unit_ : decimal_step(decimals_); }

double StepCounter::coordinate(std::int64_t steps) const noexcept {
  return unit_ > 0.0 ? origin_ + static_cast<double>(steps) * unit_
                     : static_cast<double>(steps) / static_cast<double>(power_of_ten(decimals_));
}

double StepCounter::rest(Decimal value) const noexcept {
  if (unit_ > 0.0) {
    return to_double(value) - coordinate(steps(value));
  }
  if (value.decimals <= decimals_) {
    return 0.0;
  }
  const auto length = [](std::int64_t mantissa, int decimals) {
    return static_cast<long double>(mantissa) / static_cast<long double>(power_of_ten(decimals));
  };
  return static_cast<double>(length(value.mantissa, value.decimals) -
                             length(steps(value), decimals_));
}

int DecimalRange::decimals() const noexcept {
  for (int d = 18; d > 0; --d) {
    if (extremes_[static_cast<std::size_t>(d)].low <= extremes_[static_cast<std::size_t>(d)].high) {
      return d;
    }
  }
  return 0;
}

int DecimalRange::decimals_rounded_to(int decimals) const noexcept {
  for (int d = decimals; d > 0; --d) {
    const auto i = static_cast<std::size_t>(d);
    if (extremes_[i].low <= extremes_[i].high ||
        rounded_[static_cast<std::size_t>(decimals)] == i) {
      return d;
    }
  }
  return 0;
}

void DecimalRange::round(Decimal d) noexcept {
  for (int to = 1; to < d.decimals; ++to) {
    const auto i = static_cast<std::size_t>(to);
    if ((unsettled_ >> i & 1U) == 0U) {
      continue;
    }
    std::int64_t left = StepCounter(to).steps(d);
    std::uint32_t decimals = static_cast<std::uint32_t>(to);
    for (; decimals > 0 && left % 10 == 0; --decimals) {
      left /= 10;
    }
    rounded_[i] = std::max(rounded_[i], decimals);
    unsettled_ &= decimals == i ? ~(1U << i) : ~0U;
  }
}

void DecimalRange::join(const DecimalRange& other) noexcept {
  for (std::size_t d = 0; d < rounded_.size(); ++d) {
    rounded_[d] = std::max(rounded_[d], other.rounded_[d]);
  }
  unsettled_ &= other.unsettled_;
  for (std::size_t d = 0; d < extremes_.size(); ++d) {
    extremes_[d].low = std::min(extremes_[d].low, other.extremes_[d].low);
    extremes_[d].high = std::max(extremes_[d].high, other.extremes_[d].high);
  }
}

void PointExtent::join(const PointExtent& other) noexcept {
  x.join(other.x);
  y.join(other.y);
  z.join(other.z);
  points += other.points;
  far.join(other.far);
  longitudes.join(other.longitudes);
}

void UnitsTaken::join(const UnitsTaken& other) noexcept {
  for (std::size_t i = 0; i < bits_.size(); ++i) {
    bits_[i] |= other.bits_[i];
  }
}

bool UnitsTaken::are_split() const noexcept {
  constexpr std::size_t kHalf = 180;
  std::size_t first = bits_.size() * 64, last = 0, longest = 0;
  for (std::size_t unit = 0; unit < bits_.size() * 64; ++unit) {
    if ((bits_[unit / 64] >> (unit % 64) & 1U) == 0) {
      continue;
    }
    longest = first > unit ? 0 : std::max(longest, unit - last - 1);
    first = std::min(first, unit);
    last = unit;
  }
  return last > first + kHalf && longest >= kHalf;
}

DecimalRange::Extreme DecimalRange::in_steps(const StepCounter& counter) const noexcept {
  Extreme all;
  for (int d = 0; d <= decimals(); ++d) {
    const Extreme& e = extremes_[static_cast<std::size_t>(d)];
    if (e.low <= e.high) {
      all.low = std::min(all.low, counter.steps({e.low, d}));
      all.high = std::max(all.high, counter.steps({e.high, d}));
    }
  }
  return all;
}

double PointGrid::shift(const SourcePoint& p) const noexcept {
  return x.is_exact() && y.is_exact() && !drops_digits ? 0.0 : shift_of_line(p);
}

double PointGrid::shift_of_line(const SourcePoint& p) const noexcept {
  const double dx = x.shift(p.x), dy = y.shift(p.y);
  return std::sqrt(dx * dx + dy * dy);
}

AffineMap PointGrid::map() const noexcept {
  return {x.coordinate(west), y.coordinate(south), x.unit(), y.unit()};
}

PointGridScan::PointGridScan(std::optional<double> resolution, const std::string& context)
    : resolution_(resolution), context_(context) {
  if (resolution_ && !(std::isfinite(*resolution_) && *resolution_ > 0)) {
    throw Error(ErrorCode::invalid_argument, "the resolution must be a finite length above 0",
                context_);
  }
}

namespace {

/// Whether two lattices have the same points. Offsets are often computed, so a millionth of a step is none.
bool are_one(const SourceLattice& a, const SourceLattice& b) {
  const auto is_whole = [](double steps) { return std::abs(steps - std::round(steps)) < 1e-6; };
  return a.unit == b.unit && is_whole((a.origin_x - b.origin_x) / a.unit) &&
         is_whole((a.origin_y - b.origin_y) / a.unit);
}

}  // namespace

void PointGridScan::add_source(const PointStreamFacts& facts) {
  plan_decimals_ = std::max(plan_decimals_, facts.plan_decimals);
  height_decimals_ = std::max(height_decimals_, facts.height_decimals);
  if (has_sources_) {
    is_common_ = is_common_ && facts.lattice.has_value() == lattice_.has_value() &&
                 (!lattice_ || are_one(*facts.lattice, *lattice_));
  }
  has_sources_ = true;
  if (facts.lattice && (!lattice_ || facts.lattice->unit < lattice_->unit)) {
    lattice_ = facts.lattice;
  }
}

void PointGridScan::add_line_vertex(const SourcePoint& v, bool has_height, bool degrees) noexcept {
  most_line_decimals_ = degrees ? kMostDegreeDecimals : kMostLineDecimals;
  line_x_.add(v.x);
  line_y_.add(v.y);
  if (has_height) {
    line_z_.add(v.z);
  }
}

bool PointGridScan::lines_are_elsewhere() const noexcept {
  const StepCounter fine(6);  // any steps do for a comparison
  const auto apart = [&](const DecimalRange& points, const DecimalRange& lines) {
    return lines.lowest(fine) > points.highest(fine) || lines.highest(fine) < points.lowest(fine);
  };
  return apart(extent_.x, line_x_) || apart(extent_.y, line_y_);
}

void PointGridScan::set_bounds(PointGrid& grid) const {
  grid.west = std::min(extent_.x.lowest(grid.x), line_x_.lowest(grid.x));
  grid.south = std::min(extent_.y.lowest(grid.y), line_y_.lowest(grid.y));
  grid.east = std::max(extent_.x.highest(grid.x), line_x_.highest(grid.x));
  grid.north = std::max(extent_.y.highest(grid.y), line_y_.highest(grid.y));
}

/// Sets the bounds; true when positions are grid points, and doubles tell the steps apart.
bool PointGridScan::fits(PointGrid& grid) const {
  set_bounds(grid);
  const auto is_fine = [](std::int64_t low, std::int64_t high, const StepCounter& steps) {
    const double a = static_cast<double>(low), b = static_cast<double>(high);
    const double farthest =
        std::max(std::abs(steps.coordinate(low)), std::abs(steps.coordinate(high)));
    return b - a <= kGridMax && farthest / steps.unit() <= kMostStepsFromZero;
  };
  return is_fine(grid.west, grid.east, grid.x) && is_fine(grid.south, grid.north, grid.y);
}

void PointGridScan::choose_steps(PointGrid& grid) const {
  if (resolution_) {
    grid.x = grid.y = StepCounter(*resolution_, 0.0);
    set_bounds(grid);
    return;
  }
  // Points of a source that lies on another lattice would move by up to half a step of this one.
  if (lattice_ && is_common_) {
    grid.x = StepCounter(lattice_->unit, lattice_->origin_x);
    grid.y = StepCounter(lattice_->unit, lattice_->origin_y);
    if (fits(grid)) {
      return;
    }
  }
  const int of_lines =
      std::min(most_line_decimals_, std::max(line_x_.decimals(), line_y_.decimals()));
  int decimals = std::max({plan_decimals_, extent_.x.decimals(), extent_.y.decimals(), of_lines});
  grid.x = grid.y = StepCounter(decimals);
  while (!fits(grid) && decimals > 0) {
    grid.x = grid.y = StepCounter(--decimals);
    grid.drops_digits = true;
  }
  if (grid.drops_digits) {
    decimals = std::max({std::min(plan_decimals_, decimals), std::min(of_lines, decimals),
                         extent_.x.decimals_rounded_to(decimals),
                         extent_.y.decimals_rounded_to(decimals)});
    grid.x = grid.y = StepCounter(decimals);
    set_bounds(grid);
  }
}

PointGrid PointGridScan::grid() const {
  PointGrid grid;
  choose_steps(grid);
  grid.is_split = extent_.longitudes.are_split();
  // Differences of numbers up to 2^62 fit; as doubles they are near enough for a limit of 2^30.
  const double width = static_cast<double>(grid.east) - static_cast<double>(grid.west);
  const double height = static_cast<double>(grid.north) - static_cast<double>(grid.south);
  check_extent(std::max(width, height) * grid.x.unit(), grid.x.unit(), context_);
  const int of_lines = std::min(kMostLineDecimals, line_z_.decimals());
  grid.heights = StepCounter(std::max({height_decimals_, extent_.z.decimals(), of_lines}));
  const auto low = std::min(extent_.z.lowest(grid.heights), line_z_.lowest(grid.heights));
  const auto high = std::max(extent_.z.highest(grid.heights), line_z_.highest(grid.heights));
  grid.whole =
      static_cast<double>(low) >= -kLargestCode && static_cast<double>(high) <= kLargestCode;
  return grid;
}

std::optional<LeftOutReason> why_left_out(const SourcePoint& p,
                                          const SourceOptions& options) noexcept {
  if (options.nodata && to_double(p.z) == *options.nodata) {
    return LeftOutReason::kNodata;
  }
  if (!options.bbox) {
    return std::nullopt;
  }
  const double x = to_double(p.x), y = to_double(p.y);
  const bool is_inside = options.bbox->min_x <= x && x <= options.bbox->max_x &&
                         options.bbox->min_y <= y && y <= options.bbox->max_y;
  return is_inside ? std::nullopt : std::optional(LeftOutReason::kBounds);
}

}  // namespace ptin
