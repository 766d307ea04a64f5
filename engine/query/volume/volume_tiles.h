// SPDX-License-Identifier: GPL-3.0-or-later
//
// A volume's sums, tile by tile on threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/living/living_place.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/volume/plane_area.h"
#include "engine/query/volume/region_cutter.h"
#include "engine/query/volume/volume.h"
#include "engine/query/volume/volume_border.h"
#include "engine/query/volume/volume_sums.h"

namespace ptin {

/// One terrain of a volume, as all tiles see it. Borrowed parts outlive it. Threads: immutable.
struct VolumeSide {
  VolumeSide(const OpenedTerrain& terrain, const VolumeRequest& request, QueryContext& context);

  [[nodiscard]] const StoreFacts& facts() const noexcept { return terrain.store().facts(); }
  /// The triangles in a box that matter: those of the region, and as far around as borders do.
  [[nodiscard]] LivingPlace place(const GridBox& box) const;
  /// Height's unit, finite. The full TIN is no farther from the triangle where both are surface.
  [[nodiscard]] double deviation(const LivingTriangle& t) const noexcept;
  /// The heights that the full TIN can have below the triangle; empty: it is void there.
  [[nodiscard]] Interval heights(const LivingTriangle& t) const noexcept;
  /// Which edges of borders matter; none do where the move is 0 or nothing bounds it.
  [[nodiscard]] std::optional<BorderScope> border_scope() const;

  const OpenedTerrain& terrain;
  Detail detail;
  PlaneArea plane;
  bool is_exact;                       ///< The level is the full TIN of the source.
  std::optional<RegionCutter> cutter;  ///< On the terrain's grid.
  double border_move = 0.0;            ///< Ground units.
  MapPoint border_reach;  ///< Twice that, grid units; infinite where nothing bounds it.

 private:
  std::unique_ptr<const StarPredicate> stars_;  ///< The places that are asked; null: everywhere.
};

/// The heights of a terrain's source, its base deviation added on either side; empty where there is
/// no surface.
[[nodiscard]] Interval source_heights(const StoreFacts& facts) noexcept;

/// What a walk over tiles adds up. Threads: one owner.
struct VolumeTotals {
  /// @param most_heights  Most heights of each of the sums.
  VolumeTotals(double most_area, std::span<const double> most_heights, double longest_edge)
      : border{FixedSum(std::ldexp(longest_edge, 36)), 0} {
    for (const double most : most_heights) sums.emplace_back(most_area, most);
  }
  void add(const VolumeTotals& other);

  std::vector<VolumeSums> sums;  ///< One a level; of an overlay one.
  BorderLength border;
  QueryCost cost;
  std::uint64_t tiles = 0;
};

/// The triangles of one terrain, each in the tile that holds its corner of smallest key, against
/// levels; with the length of its border. @throws Error as volume()
[[nodiscard]] VolumeTotals volume_above_levels(const VolumeSide& side,
                                               std::span<const double> levels,
                                               const VolumeRequest& request);

/// The overlay of two terrains: each pair of triangles in the tile that holds the lowest corner of
/// what they share. Borders are not looked at. @throws Error as volume()
[[nodiscard]] VolumeTotals volume_of_overlay(const VolumeSide& side, const VolumeSide& other,
                                             const VolumeRequest& request);

}  // namespace ptin
