// SPDX-License-Identifier: GPL-3.0-or-later
//
// Volumes between a terrain and a level, or between two terrains.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/select/accounting.h"
#include "engine/query/select/certificate.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/select/region.h"
#include "engine/query/volume/plane_area.h"

namespace ptin {

struct VolumeRequest {
  double level = 0.0;  ///< The plane below or above which is measured, height's unit.
  /// A second terrain in the place of the plane, on any grid, in the same map units; null: none.
  /// Borrowed for the call.
  const OpenedTerrain* other = nullptr;
  double other_height_scale = 1.0;  ///< The terrain's heights' units in one of the other's, > 0.
  std::optional<Region> region;     ///< A window or a polygon, map units. None: everywhere.
  DetailRequest detail;             ///< The TIN, of both terrains.
  GroundScale ground;  ///< Lengths over ground; as long as a unit of heights for cubic units.
  /// How far the border of voids of a store may have moved, in ground units, in an answer that
  /// certifies an error (engine/DESIGN.md, section 3.2). Null: any distance, where there are voids.
  std::function<double(const StoreFile&, double certified_error)> border_move;
  QueryLimits limits;
  int threads = 1;  ///< At most; fewer where the memory is small. The result does not depend on it.
  /// Bytes of what a tile keeps, where the memory allows. The result does not depend on it.
  std::uint64_t tile_bytes = std::uint64_t{32} << 20;
};

/// A volume of the TIN that was asked, and bounds of that of the source's full TIN.
struct CertifiedVolume {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// The difference is the height of the terrain less the level or the height of the other terrain;
/// cut is where it is above 0, fill where it is below. Areas are those of the plane over ground.
///
/// Volumes and areas are exact integrals over the triangles, or over those of the overlay of both
/// meshes, and over their parts in the region; what rounding can have changed is told. They are
/// added in fixed point, so every bit is the same for any memory, tiles and number of threads.
struct VolumeResult {
  CertifiedVolume cut, fill, net;  ///< `net` is cut less fill.
  double rounding = 0.0;           ///< Most that rounding changed cut, fill or net; in all bounds.
  double cut_area = 0.0, fill_area = 0.0;
  double surface_area = 0.0;  ///< Where the difference is known: the terrain, and the other, is
                              ///< surface.
  double void_area = 0.0;     ///< Within the domain (of both), and void (in either).
  /// Where one terrain is surface and the other is not: void, or outside of its domain. 0 without
  /// another one.
  double only_here_area = 0.0, only_other_area = 0.0;
  /// Net volume by surface area, height's unit; NaN where there is no surface.
  double mean_difference = std::numeric_limits<double>::quiet_NaN();
  Certificate certificate, other_certificate;  ///< Certificates of the TINs that were asked.
  double border_move = 0.0;  ///< Largest of either terrain, ground units; +infinity: not bounded.
  bool exact = false;        ///< Both TINs are the full ones of their sources.
  std::uint64_t tiles = 0;   ///< Parts in which the terrains were processed.
  QueryCost cost;
};

/// Measures volumes, tile by tile within the memory limit.
///
/// Bounds (engine/DESIGN.md, section 6.14): a difference is off by at most the deviations of its
/// triangles' makers; and ground within twice the border's move of a border of voids may be of
/// another class in the source, with any height that the source has. They are finite always.
/// @throws Error invalid_argument    level or scale are not finite; the region has no inside; as
///                                   GridRegion and Detail
///               resource_exhausted  the smallest tile does not fit
///               corruption, io_error, cancelled
/// Cost: the pages with living triangles in the region, twice when there is another terrain; those
/// that meet several tiles are read for each of them. The overlay takes O(n log n). Memory: a page
/// for a level where no border matters; else what a tile keeps.
[[nodiscard]] VolumeResult volume(const OpenedTerrain& terrain, const VolumeRequest& request);

/// The volumes of several levels, in their order: each bit for bit what volume() gives for it, all of
/// them from one pass over the triangles, whose cost each result tells. `request.level` is not looked
/// at.
/// @throws Error as volume(); invalid_argument  no level; another terrain besides
///               resource_exhausted  the sums of so many levels do not fit the memory
/// Cost: as volume(), with the sums of each triangle once a level. Memory: a KiB a level and thread.
[[nodiscard]] std::vector<VolumeResult> volumes(const OpenedTerrain& terrain,
                                                const VolumeRequest& request,
                                                std::span<const double> levels);

}  // namespace ptin
