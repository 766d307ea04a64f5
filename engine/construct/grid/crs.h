// SPDX-License-Identifier: GPL-3.0-or-later
//
// Coordinate reference systems: what a source declares and its caller overrides, as WKT2:2019 text
// and names of units; and how long a step of the grid is on the ground.
#pragma once

#include <cstdint>
#include <string>

#include "engine/construct/grid/terrain_frame.h"

namespace ptin {

/// A horizontal or compound CRS, or none.
struct Crs {
  std::string wkt;  ///< WKT2:2019 on one line; empty when unknown.
  bool geographic = false;
  bool vertical_known = false;  ///< A compound CRS, or a three-dimensional one.
  std::string horizontal_unit = "unknown";
  std::string vertical_unit = "unknown";
};

/// The CRS of a source.
/// @param declared      What the source says: anything GDAL understands; "" for nothing.
/// @param a_srs         Takes the place of `declared`, its vertical part included; "" keeps it.
/// @param vertical_crs  Takes the place of the vertical part, or adds one; "" keeps it.
/// Nothing is fetched from the network.
/// @throws Error  invalid_argument  GDAL does not understand a text; `a_srs` or `declared` is
///                                  neither geographic nor projected nor local; `vertical_crs` is
///                                  not a vertical CRS, or there is no horizontal one to add it to
/// Cost: up to milliseconds (PROJ's database). Threads: any number of calls at once.
[[nodiscard]] Crs resolve_crs(const std::string& declared, const std::string& a_srs,
                              const std::string& vertical_crs);

/// True when two texts name the same CRS, or both are empty. Axis order is not looked at.
[[nodiscard]] bool is_same_crs(const std::string& wkt_a, const std::string& wkt_b);

/// Writes what `crs` says into `frame`.
void set_crs(TerrainFrame& frame, const Crs& crs);

/// @param rows  Grid steps from the southernmost to the northernmost sample.
/// @throws Error invalid_argument  the CRS has degrees, and y is none: metres, most likely
void require_latitudes(const TerrainFrame& frame, std::int64_t rows, const std::string& context);

/// Lengths of one grid step on the ground.
struct GroundStep {
  double x = 1.0;
  double y = 1.0;
  friend bool operator==(const GroundStep&, const GroundStep&) = default;
};

/// Ground distances in the plane of the grid: in a geographic CRS metres at a sample's own row (on
/// the ellipsoid, where a degree of longitude shrinks towards the poles), else units of the CRS. A
/// pole's own row has steps of length 0 in x.
class GroundMetric {
 public:
  /// @throws Error invalid_argument  the frame's CRS is not one that GDAL understands
  explicit GroundMetric(const TerrainFrame& frame);

  /// The steps at grid row `y`. Cost: a few dozen operations.
  [[nodiscard]] GroundStep at(double grid_y) const noexcept;
  /// True when every row has the same steps.
  [[nodiscard]] bool is_uniform() const noexcept { return semi_major_m_ == 0.0; }

 private:
  AffineMap map_;
  double radians_per_unit_ = 0.0;
  double semi_major_m_ = 0.0;  ///< 0 when not geographic.
  double eccentricity_squared_ = 0.0;
};

}  // namespace ptin
