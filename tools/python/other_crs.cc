// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/python/other_crs.h"

#include <utility>

#include <cpl_error.h>
#include <gdal.h>

#include "engine/error.h"
#include "engine/stop.h"
#include "tools/region/on_terrain.h"
#include "tools/region/region_input.h"

namespace ptin::python {

namespace {

/// The plane of a CRS: heights of questions are the terrain's own, whatever the CRS says of them.
bool set_plane(OGRSpatialReference& plane, const std::string& crs) {
  if (crs.empty() || plane.SetFromUserInput(crs.c_str()) != OGRERR_NONE) return false;
  plane.DemoteTo2D(nullptr);
  plane.StripVertical();
  plane.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return true;
}

/// Lines or rings of another CRS in the terrain's.
std::vector<py::array_t<double>> paths_of_crs(const OpenTerrain& t,
                                              const std::vector<Numbers>& paths,
                                              const std::string& crs) {
  std::vector<std::span<const MapPoint>> corners;
  for (const Numbers& path : paths) corners.push_back(points_of(path));
  std::vector<std::vector<double>> there(paths.size());
  std::stop_source stop;
  run_interruptibly(stop, [&] {
    const OtherCrs other(crs, t);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      stop_if_asked(stop.get_token(), "the question");
      for (const MapPoint& p : other.path(corners[i])) {
        there[i].insert(there[i].end(), {p.x, p.y});
      }
    }
    return true;
  });
  std::vector<py::array_t<double>> arrays;
  for (std::vector<double>& path : there) arrays.push_back(table_of(std::move(path), 2));
  return arrays;
}

/// The rings of the polygon that a file or WKT has, in the terrain's CRS: what --polygon takes.
std::vector<py::array_t<double>> rings_of_file(const OpenTerrain& t, const std::string& text) {
  std::stop_source stop;
  const Polygon polygon = run_interruptibly(stop, [&] {
    const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
    GDALAllRegister();  // of which a process that only asks has none yet
    return tools::read_polygon(text, tools::plane_of(t.terrain.store().facts(), t.crs)).polygon;
  });
  std::vector<py::array_t<double>> rings;
  for (const std::vector<MapPoint>& ring : polygon.rings) {
    std::vector<double> numbers;
    for (const MapPoint& p : ring) numbers.insert(numbers.end(), {p.x, p.y});
    rings.push_back(table_of(std::move(numbers), 2));
  }
  return rings;
}

/// Why corners of a region miss the terrain; none where one does not.
std::optional<std::string> why_missed(const OpenTerrain& t, const Numbers& corners) {
  return tools::why_all_miss(points_of(corners), t.terrain.store().facts(), t.crs);
}

}  // namespace

OtherCrs::OtherCrs(const std::string& crs, const OpenTerrain& t)
    : sides_(tools::plane_of(t.terrain.store().facts(), t.crs).sides) {
  const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
  OGRSpatialReference from, to;
  if (!set_plane(to, t.crs.wkt)) {
    refuse("the CRS of the terrain is unknown, so no positions of another one can be taken to it");
  }
  if (!set_plane(from, crs)) {
    refuse("\"" + crs + "\" is no CRS that is known; give a code as EPSG:4326, or WKT", "crs");
  }
  sides_.source_turns = tools::has_degrees(from);
  if (from.IsSame(&to) != 0) return;
  way_.reset(OGRCreateCoordinateTransformation(&from, &to));
  if (!way_) refuse("no way is known from \"" + crs + "\" to the CRS of the terrain", "crs");
}

void OtherCrs::take(std::span<MapPoint> points) const {
  const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
  if (way_) tools::places_by (*way_)(points);
  tools::turn_to_bounds(points, sides_);
}

std::vector<MapPoint> OtherCrs::path(std::span<const MapPoint> corners) const {
  const CPLErrorHandlerPusher silent(CPLQuietErrorHandler);
  const tools::PlaceTransform there =
      way_ ? tools::places_by(*way_) : [](std::span<MapPoint> /*as they are*/) {};
  return tools::transformed_sides(corners, there, sides_);
}

void add_places(py::module_& module) {
  module.def("paths_of_crs", paths_of_crs);
  module.def("rings_of_file", rings_of_file);
  module.def("why_missed", why_missed);
}

}  // namespace ptin::python
