// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/area_of_use.h"

#include <cmath>
#include <memory>

#include <ogr_spatialref.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/geometry/affine.h"

namespace ptin {

namespace {

/// An area of longitudes and latitudes; its west may lie east of its east.
struct Area {
  double west = 0.0, south = 0.0, east = 0.0, north = 0.0;

  [[nodiscard]] bool holds(double longitude, double latitude) const {
    constexpr double kMargin = 2.0;  // degrees: CRSs are used somewhat beyond their areas
    const bool is_between = west <= east
                                ? longitude >= west - kMargin && longitude <= east + kMargin
                                : longitude >= west - kMargin || longitude <= east + kMargin;
    return is_between && latitude >= south - kMargin && latitude <= north + kMargin;
  }
};

}  // namespace

bool are_axes_exchanged(const TerrainFrame& frame, std::int64_t columns, std::int64_t rows) {
  if (frame.crs_wkt.empty()) {
    return false;
  }
  const GdalSession session;
  OGRSpatialReference srs;
  Area area;
  if (srs.importFromWkt(frame.crs_wkt.c_str()) != OGRERR_NONE ||
      !srs.GetAreaOfUse(&area.west, &area.south, &area.east, &area.north, nullptr)) {
    return false;
  }
  srs.StripVertical();
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRSpatialReference> degrees(srs.CloneGeogCS());
  if (!degrees) {
    return false;
  }
  degrees->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> to_degrees(
      OGRCreateCoordinateTransformation(&srs, degrees.get()));
  const auto is_inside = [&](double x, double y) {
    return to_degrees->Transform(1, &x, &y) != 0 && std::isfinite(x) && std::isfinite(y) &&
           area.holds(x, y);
  };
  const MapPoint middle =
      frame.map.to_map(0.5 * static_cast<double>(columns), 0.5 * static_cast<double>(rows));
  return to_degrees && !is_inside(middle.x, middle.y) && is_inside(middle.y, middle.x);
}

}  // namespace ptin
