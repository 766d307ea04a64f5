// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/serve/wkt_places.h"

#include <cmath>
#include <memory>

#include <ogr_geometry.h>

#include "tools/http/problem.h"
#include "tools/region/vector_input.h"

namespace ptin::serve {

namespace {

std::unique_ptr<OGRGeometry> geometry_of(const std::string& wkt, std::string_view parameter,
                                         const char* example) {
  std::unique_ptr<OGRGeometry> geometry = tools::geometry_of_wkt(wkt);
  if (geometry && geometry->IsEmpty() == 0) return geometry;
  throw http::Problem(400, std::string("this is no WKT with a position; write it as ") + example)
      .at(std::string(parameter));
}

[[noreturn]] void throw_other_shape(std::string_view parameter, const char* expected) {
  throw http::Problem(400, std::string("this question takes ") + expected)
      .at(std::string(parameter));
}

MapPoint checked(double x, double y, std::string_view parameter) {
  if (std::isfinite(x) && std::isfinite(y)) return {x, y};
  throw http::Problem(400, "a coordinate is not finite").at(std::string(parameter));
}

std::vector<MapPoint> points_of(const OGRSimpleCurve& curve, std::string_view parameter) {
  std::vector<MapPoint> points;
  for (int i = 0; i < curve.getNumPoints(); ++i) {
    points.push_back(checked(curve.getX(i), curve.getY(i), parameter));
  }
  return points;
}

void add_rings(Polygon& polygon, const OGRPolygon& shape, std::string_view parameter) {
  for (const OGRLinearRing* ring : shape) {
    polygon.rings.push_back(points_of(*ring, parameter));
    if (polygon.rings.back().size() < 4) {
      throw http::Problem(400, "a ring has at least three positions, and the first one again")
          .at(std::string(parameter));
    }
  }
}

}  // namespace

std::vector<MapPoint> points_of_wkt(const std::string& wkt, std::string_view parameter) {
  const auto geometry = geometry_of(wkt, parameter, "POINT(-118.2 34.3)");
  std::vector<MapPoint> points;
  const auto add = [&](const OGRPoint& p) {
    points.push_back(checked(p.getX(), p.getY(), parameter));
  };
  switch (wkbFlatten(geometry->getGeometryType())) {
    case wkbPoint:
      add(*geometry->toPoint());
      return points;
    case wkbMultiPoint:
      for (const OGRPoint* p : *geometry->toMultiPoint()) add(*p);
      return points;
    default:
      throw_other_shape(parameter, "POINT or MULTIPOINT");
  }
}

std::vector<std::vector<MapPoint>> lines_of_wkt(const std::string& wkt,
                                                std::string_view parameter) {
  const auto geometry = geometry_of(wkt, parameter, "LINESTRING(-118.2 34.3, -118.1 34.4)");
  std::vector<std::vector<MapPoint>> lines;
  switch (wkbFlatten(geometry->getGeometryType())) {
    case wkbLineString:
      lines.push_back(points_of(*geometry->toLineString(), parameter));
      return lines;
    case wkbMultiLineString:
      for (const OGRLineString* line : *geometry->toMultiLineString()) {
        lines.push_back(points_of(*line, parameter));
      }
      return lines;
    default:
      throw_other_shape(parameter, "LINESTRING or MULTILINESTRING");
  }
}

Polygon polygon_of_wkt(const std::string& wkt, std::string_view parameter) {
  const auto geometry =
      geometry_of(wkt, parameter, "POLYGON((-118.2 34.3, -118.1 34.3, -118.1 34.4, -118.2 34.3))");
  Polygon polygon;
  switch (wkbFlatten(geometry->getGeometryType())) {
    case wkbPolygon:
      add_rings(polygon, *geometry->toPolygon(), parameter);
      return polygon;
    case wkbMultiPolygon:
      for (const OGRPolygon* shape : *geometry->toMultiPolygon()) {
        add_rings(polygon, *shape, parameter);
      }
      return polygon;
    default:
      throw_other_shape(parameter, "POLYGON or MULTIPOLYGON");
  }
}

}  // namespace ptin::serve
