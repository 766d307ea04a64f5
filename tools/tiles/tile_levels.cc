// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/tile_levels.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "tools/tiles/tile_grid.h"

namespace ptin::tools {

namespace {

double power_of_two_below(double v) { return std::ldexp(1.0, std::ilogb(v)); }

double power_of_two_above(double v) {
  const double below = power_of_two_below(v);
  return below < v ? 2 * below : below;
}

/// The finest step of heights with which every tile can be written: all heights of the terrain are
/// at most kTileSteps apart, and fit a float32 (quantized_mesh.h).
double finest_step(const Globe& globe) {
  const double range = globe.max_height() - globe.min_height();
  const double most = std::max(std::abs(globe.min_height()), std::abs(globe.max_height()));
  return power_of_two_above(std::max({range / static_cast<double>(kTileSteps - 2),
                                      most / std::ldexp(1.0, 22), std::ldexp(1.0, -10)}));
}

/// The least positive error in the file, metres; 0 when there is none.
double finest_error(const StoreFile& store, const Globe& globe) {
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.upper > 0 && bin.records > 0 && std::isfinite(bin.upper))
      return bin.upper * globe.metres_per_height();
  }
  return 0.0;
}

TileLevel level_of(double error, double least_step, const Globe& globe) {
  TileLevel level;
  level.error = error;
  level.height_step = std::max(least_step, power_of_two_below(error / 8));
  level.chord = error / 8;
  level.tolerance = (error * 13 / 16 - level.height_step / 2) / globe.metres_per_height();
  return level;
}

}  // namespace

std::vector<TileLevel> tile_levels(const StoreFile& store, const Globe& globe,
                                   const LevelsWanted& wanted) {
  const double least_step = finest_step(globe);
  // The TIN of the finest level is to be at least as good as the file's finest error and, where
  // that is worse, its base error; half an error is left beside its step.
  const double base = store.facts().base_error * globe.metres_per_height();
  const double finest = std::max({2 * least_step, finest_error(store, globe), base * 16 / 9});
  const auto vertices =
      static_cast<double>(store.record_count() + store.t0().vertices.size()) * wanted.first_area;
  std::vector<TileLevel> levels;
  for (int z = 0; z < wanted.most_levels; ++z) {
    const double error = std::ldexp(wanted.first_error, -z);
    const bool is_sparse =
        z >= wanted.least_finest &&
        std::ldexp(vertices, -2 * z) <= static_cast<double>(wanted.mean_vertices);
    if (is_sparse || error < 2 * finest || z + 1 == wanted.most_levels) {
      levels.push_back(level_of(std::max(finest, error / 16), least_step, globe));
      break;
    }
    levels.push_back(level_of(error, least_step, globe));
  }
  return levels;
}

double coarsest_error(const StoreFile& store, const Globe& globe) {
  double error = store.facts().base_error;
  for (const ErrorBin& bin : store.error_bins()) {
    if (bin.records > 0 && std::isfinite(bin.upper)) error = std::max<double>(error, bin.upper);
  }
  return error * globe.metres_per_height();
}

}  // namespace ptin::tools
