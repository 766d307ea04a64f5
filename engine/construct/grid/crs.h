// SPDX-License-Identifier: GPL-3.0-or-later
//
// Coordinate reference systems: what a source declares and its caller overrides, as WKT2:2019 text
// and names of units; and how long a step of the grid is on the ground.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/grid/source_warning.h"
#include "engine/construct/grid/terrain_frame.h"

class OGRSpatialReference;

namespace ptin {

/// A CRS as WKT2:2019 on one line, its datums plain ones (plain_datum.h); "" where it cannot be
/// written so.
[[nodiscard]] std::string wkt2_of(const OGRSpatialReference& srs);

/// The texts by which a source declares its CRS; "" for none.
struct DeclaredTexts {
  std::string crs;           ///< Anything that GDAL understands.
  std::string vertical_crs;  ///< Likewise, where it is apart from `crs`.
};

/// A horizontal or compound CRS, or none.
struct Crs {
  std::string wkt;              ///< WKT2:2019 on one line; empty when unknown.
  bool geographic = false;      ///< x and y are longitude and latitude.
  bool vertical_known = false;  ///< `wkt` has a vertical part: it is compound or has three axes.
  std::string horizontal_unit = "unknown";
  std::string vertical_unit = "unknown";
};

/// The CRS of a source; an empty Crs when `declared`, `a_srs` and `vertical_crs` are all empty.
/// @param declared      The CRS that the source declares: any text that GDAL understands; "" for
///                      none.
/// @param a_srs         Replaces `declared`, its vertical part included; "" keeps `declared`.
/// @param vertical_crs  Replaces the vertical part of the CRS, or adds one; "" keeps the CRS as it
///                      is.
/// No text makes GDAL open a file or use the network.
/// @throws Error  invalid_argument  GDAL does not understand a text; `a_srs` or `declared` is
///                                  neither geographic nor projected nor local; its vertical axis points
///                                  down; `vertical_crs` is not a vertical CRS, or there is no horizontal one to add it to
/// Cost: up to milliseconds (PROJ's database). Threads: any number of calls at once.
[[nodiscard]] Crs resolve_crs(const std::string& declared, const std::string& a_srs,
                              const std::string& vertical_crs);

/// The CRS of a source, as resolve_crs(); but what the source itself declares is warned of where GDAL
/// does not understand it, and the terrain has no CRS then. A vertical CRS without a horizontal one
/// states the unit of the heights, and is warned of. So is a CRS whose axes point to the west or to
/// the south, or that counts heights downwards: coordinates and heights are taken as they are. A
/// local CRS without a name is one that nobody knows: its unit alone is kept, and it is warned of.
/// So are a CRS whose unit is not known, and a shift of heights, which is not applied.
/// @param file          The path of the source, for warnings and errors.
/// @throws Error invalid_argument  as resolve_crs(), of the options; `declared` is geocentric
[[nodiscard]] Crs resolve_source_crs(const DeclaredTexts& declared, const SourceOptions& options,
                                     const std::string& file, SourceWarnings& warnings);

/// The warnings but for those of a CRS (of kinds that begin with "crs_") in whose place the caller puts
/// another one.
/// @param lines_before  So many lines of the input come before the portion that they are of.
[[nodiscard]] SourceWarnings warnings_that_count(const SourceWarnings& all,
                                                 const SourceOptions& options,
                                                 std::uint64_t lines_before = 0);

/// True when GDAL understands a text as a CRS that a terrain may have: geographic, projected or local.
/// Cost: as resolve_crs().
[[nodiscard]] bool is_crs(const std::string& text);
/// True when GDAL understands a text as a vertical CRS and nothing else.  Cost: as resolve_crs().
[[nodiscard]] bool is_vertical_crs(const std::string& text);

/// True when two texts name the same CRS, or both are empty. The order of the axes of a geographic
/// CRS does not matter. A text that GDAL does not understand is the same as itself alone.
[[nodiscard]] bool is_same_crs(const std::string& wkt_a, const std::string& wkt_b);

/// True when two texts name CRSs that are the same in plan, whatever their vertical parts. A text that
/// GDAL does not understand is the same as itself alone.
[[nodiscard]] bool is_same_in_plan(const std::string& wkt_a, const std::string& wkt_b);

/// What two sources declare where that is not the same, in words: the horizontal parts where these
/// differ, else the vertical ones.
struct CrsDifference {
  std::string first, second;  ///< "ETRS89 / UTM zone 32N (EPSG:25832)", "no vertical CRS".
};

/// None where both declare the same, as is_same_crs().  Cost: as resolve_crs().
[[nodiscard]] std::optional<CrsDifference> difference_of(const DeclaredTexts& first,
                                                         const DeclaredTexts& second);

/// Warns of a terrain whose source declares no CRS, where no other warning says why there is none.
/// @param file  The first file of the source, which the warning names.
void warn_of_no_crs(const TerrainFrame& frame, const std::string& file, SourceWarnings& warnings);

/// Sets those fields of `frame` that describe the CRS.
void set_crs(TerrainFrame& frame, const Crs& crs);

/// Adds what a source says of its units beside a CRS: the plane's where there is no CRS, the
/// heights' where no vertical part names theirs.
/// @param is_own    The CRS is the source's own, and not one that the caller put in its place.
/// @param context   The path of the source, for the error.
/// @throws Error invalid_argument  the source's own CRS is in another unit than the source says
void set_units(TerrainFrame& frame, const DeclaredUnits& units, bool is_own,
               const std::string& context);

/// Refuses a CRS in degrees for coordinates that are no latitudes: y below -91 or above 91. Most
/// likely the coordinates are metres.
/// @param rows     Grid steps from the southernmost to the northernmost sample.
/// @param context  The path of the source, for the error.
/// @throws Error invalid_argument  as above
void require_latitudes(const TerrainFrame& frame, std::int64_t rows, const std::string& context);

/// Refuses longitudes that are none, and terrains that lie on both sides of the 180th meridian and
/// would reach around the world between them; in a CRS of degrees.
/// @param columns   Grid steps from the westernmost to the easternmost sample.
/// @param is_split  As PointGrid.
/// @param context   The path of the source, for the error.
/// @throws Error invalid_argument  as above
void require_longitudes(const TerrainFrame& frame, std::int64_t columns, bool is_split,
                        const std::string& context);

/// The lengths on the ground of one grid step in x and of one in y, in the unit of GroundMetric.
struct GroundStep {
  double x = 1.0;
  double y = 1.0;
  friend bool operator==(const GroundStep&, const GroundStep&) = default;
};

/// How long grid steps are on the ground. In a geographic CRS lengths are metres on the ellipsoid
/// and depend on the row: a degree of longitude shrinks towards the poles, and steps in x on the
/// row of a pole have no length. In any other CRS lengths are units of the CRS, and all rows have
/// the same steps.
class GroundMetric {
 public:
  /// @throws Error invalid_argument  the frame's CRS is not one that GDAL understands
  explicit GroundMetric(const TerrainFrame& frame);

  /// The steps at grid row `grid_y`, which need not be whole. Cost: a few dozen operations.
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
