// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/north.h"

#include <cmath>
#include <memory>

#include <ogr_spatialref.h>

namespace ptin::tools {

namespace {

using Way = std::unique_ptr<OGRCoordinateTransformation>;

/// The ways from a CRS to its own longitudes and latitudes, and back.
std::pair<Way, Way> ways_of(const CrsFacts& crs) {
  OGRSpatialReference plane;
  if (crs.wkt.empty() || plane.importFromWkt(crs.wkt.c_str()) != OGRERR_NONE) return {};
  plane.DemoteTo2D(nullptr);
  plane.StripVertical();
  const std::unique_ptr<OGRSpatialReference> degrees(plane.CloneGeogCS());
  if (!degrees) return {};
  for (OGRSpatialReference* of : {&plane, degrees.get()}) {
    of->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }
  return {Way(OGRCreateCoordinateTransformation(&plane, degrees.get())),
          Way(OGRCreateCoordinateTransformation(degrees.get(), &plane))};
}

}  // namespace

std::optional<double> north_at(MapPoint place, const CrsFacts& crs) {
  if (!crs.is_understood) return std::nullopt;
  if (crs.geographic) return 0.0;
  const auto [down, up] = ways_of(crs);
  if (!down || !up) return std::nullopt;
  // A step to the north of about a metre: long beside rounding, short beside the bend of meridians.
  constexpr double kStep = 1e-5;  // degrees
  double x = place.x, y = place.y;
  if (!down->Transform(1, &x, &y)) return std::nullopt;
  double south_x = x, south_y = y - kStep, north_x = x, north_y = y + kStep;
  if (!up->Transform(1, &south_x, &south_y) || !up->Transform(1, &north_x, &north_y)) {
    return std::nullopt;
  }
  const double angle = std::atan2(north_x - south_x, north_y - south_y);
  return std::isfinite(angle) ? std::optional(angle) : std::nullopt;
}

}  // namespace ptin::tools
