// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/query/raster/pixel_centres.h"

#include <algorithm>
#include <optional>

namespace ptin {

namespace {

constexpr std::int64_t kGridUnit = std::int64_t{1} << kSpotBits;

/// Whether ascending spots are whole grid units, each one more than that before it.
bool are_unit_steps(const std::vector<std::int64_t>& spots) {
  const auto is_off = [](std::int64_t a, std::int64_t b) { return b - a != kGridUnit; };
  return !spots.empty() && spots.front() % kGridUnit == 0 &&
         std::adjacent_find(spots.begin(), spots.end(), is_off) == spots.end();
}

/// Whether those of ascending spots that lie in an interval of the grid are whole grid units.
bool are_whole(const std::vector<std::int64_t>& spots, std::int32_t low, std::int32_t high) {
  return std::all_of(spots.begin(), spots.end(), [&](std::int64_t v) {
    return v % kGridUnit == 0 || v < low * kGridUnit || v > high * kGridUnit;
  });
}

/// A coordinate that lies outside of [low, high] by at most `margin`, taken to the nearer end.
double taken_in(double v, double low, double high, double margin) {
  if (v < low && low - v <= margin) return low;
  if (v > high && v - high <= margin) return high;
  return v;
}

std::int32_t grid_coordinate(std::int64_t v) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, -1, std::int64_t{kGridMax} + 1));
}

}  // namespace

PixelCentres::PixelCentres(const StoreFacts& facts, const PixelLattice& lattice,
                           const PixelRect& pixels)
    : bounds_(facts.bounds) {
  const SpotMap map(facts.map, facts.bounds);
  const MapPoint low = facts.map.to_map(facts.bounds.min_x, facts.bounds.min_y);
  const MapPoint high = facts.map.to_map(facts.bounds.max_x, facts.bounds.max_y);
  // A coordinate alone: the other one is that of a position on every map.
  const auto along = [&](Axis& axis, std::int64_t count, double step, const auto& coordinate) {
    axis.spots.resize(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < axis.spots.size(); ++i) {
      axis.spots[i] = coordinate(static_cast<std::int64_t>(i));
    }
    axis.descends = step < 0;
    if (axis.descends) std::reverse(axis.spots.begin(), axis.spots.end());
  };
  const auto beyond = [](bool is_above) { return is_above ? kSpotMax : -kSpotMax; };
  along(x_, pixels.width, lattice.step_x, [&](std::int64_t i) {
    const double x =
        taken_in(lattice.centre(pixels.column + i, 0).x, low.x, high.x, lattice.margin.x);
    const std::optional<Spot> spot = map.spot({x, low.y});
    return spot ? spot->x : beyond(x > low.x);
  });
  along(y_, pixels.height, lattice.step_y, [&](std::int64_t j) {
    const double y = taken_in(lattice.centre(0, pixels.row + j).y, low.y, high.y, lattice.margin.y);
    const std::optional<Spot> spot = map.spot({low.x, y});
    return spot ? spot->y : beyond(y > low.y);
  });
  are_on_grid_ = are_whole(x_.spots, bounds_.min_x, bounds_.max_x) &&
                 are_whole(y_.spots, bounds_.min_y, bounds_.max_y);
  are_grid_positions_ = are_unit_steps(x_.spots) && are_unit_steps(y_.spots) &&
                        contains(GridBox{0, 0, kGridMax, kGridMax}, box());
  if (are_grid_positions_) first_ = {box().min_x, box().min_y};
}

PixelCentres::GridLine PixelCentres::on_grid(const Axis& axis, std::int32_t low,
                                             std::int32_t high) {
  const auto begin = std::lower_bound(axis.spots.begin(), axis.spots.end(), low * kGridUnit);
  const auto end = std::upper_bound(begin, axis.spots.end(), high * kGridUnit);
  GridLine line{
      {}, axis.turned(static_cast<std::size_t>(begin - axis.spots.begin())), axis.descends};
  for (auto spot = begin; spot != end; ++spot) {
    line.at.push_back(static_cast<std::int32_t>(*spot / kGridUnit));
  }
  return line;
}

GridBox PixelCentres::box() const noexcept {
  const auto down = [](std::int64_t v) { return grid_coordinate(v >> kSpotBits); };
  const auto up = [](std::int64_t v) { return grid_coordinate(-(-v >> kSpotBits)); };
  return {down(x_.spots.front()), down(y_.spots.front()), up(x_.spots.back()), up(y_.spots.back())};
}

bool PixelCentres::misses(const GridBox& box) const noexcept {
  const Spot low = spot_of(GridPoint{box.min_x, box.min_y});
  const Spot high = spot_of(GridPoint{box.max_x, box.max_y});
  return high.y < y_.spots.front() || low.y > y_.spots.back() || high.x < x_.spots.front() ||
         low.x > x_.spots.back();
}

std::size_t PixelCentres::Axis::first_from(std::int64_t v) const noexcept {
  const auto last = static_cast<double>(spots.size() - 1);
  const auto whole = static_cast<double>(spots.back() - spots.front());
  const double share = static_cast<double>(v - spots.front()) / std::max(whole, 1.0);
  const auto guess = static_cast<std::size_t>(std::clamp(share * last, 0.0, last));
  // Rounding is off by a place or two; anything else is searched for.
  for (std::size_t i = guess > 1 ? guess - 1 : 0; i < std::min(guess + 3, spots.size()); ++i) {
    if (spots[i] >= v && (i == 0 || spots[i - 1] < v)) return i;
  }
  return static_cast<std::size_t>(std::lower_bound(spots.begin(), spots.end(), v) - spots.begin());
}

}  // namespace ptin
