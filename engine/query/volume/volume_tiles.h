// SPDX-License-Identifier: GPL-3.0-or-later
//
// A volume's sums, tile by tile on threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
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
  /// Where records are wanted: those of the region, and as far around as borders matter. Null:
  /// everywhere.
  [[nodiscard]] PredicatePtr wanted() const;
  /// Which edges of borders matter; none do where the move is 0 or nothing bounds it.
  [[nodiscard]] std::optional<BorderScope> border_scope() const;

  const OpenedTerrain& terrain;
  Detail detail;
  PlaneArea plane;
  std::optional<RegionCutter> cutter;  ///< On the terrain's grid.
  PredicatePtr in_region;              ///< Null: no region.
  double border_move = 0.0;            ///< Ground units.
  MapPoint border_reach;  ///< Twice that, grid units; infinite where nothing bounds it.
};

/// What a walk over tiles adds up. Threads: one owner.
struct VolumeTotals {
  VolumeTotals(double most_area, double most_height, double longest_edge)
      : sums(most_area, most_height), border{FixedSum(std::ldexp(longest_edge, 36)), 0} {}
  void add(const VolumeTotals& other);

  VolumeSums sums;
  BorderLength border;
  QueryCost cost;
  std::uint64_t tiles = 0;
};

/// The triangles of one terrain, each in the tile that holds its corner of smallest key, against a
/// level; with the length of its border. @throws Error as volume()
[[nodiscard]] VolumeTotals volume_above_level(const VolumeSide& side, double level,
                                              const VolumeRequest& request);

/// The overlay of two terrains: each pair of triangles in the tile that holds the lowest corner of
/// what they share. Borders are not looked at. @throws Error as volume()
[[nodiscard]] VolumeTotals volume_of_overlay(const VolumeSide& side, const VolumeSide& other,
                                             const VolumeRequest& request);

}  // namespace ptin
