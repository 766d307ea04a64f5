// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/region_input.h"

#include <memory>
#include <utility>
#include <vector>

#include <ogr_geometry.h>

#include "engine/error.h"
#include "tools/region/vector_input.h"

namespace ptin::tools {

namespace {

void add_ring(const OGRLinearRing& ring, Polygon& polygon) {
  std::vector<MapPoint> points;
  for (int i = 0; i < ring.getNumPoints(); ++i) points.push_back({ring.getX(i), ring.getY(i)});
  if (points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (points.size() >= 3) polygon.rings.push_back(std::move(points));
}

void add_geometry(const OGRGeometry& geometry, Polygon& polygon) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    for (const OGRLinearRing* ring : *geometry.toPolygon()) add_ring(*ring, polygon);
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection) != 0) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) add_geometry(*part, polygon);
  } else if (type == wkbCurvePolygon) {
    const std::unique_ptr<OGRGeometry> linear(geometry.getLinearGeometry());
    add_geometry(*linear, polygon);
  }
}

}  // namespace

Polygon read_polygon(const std::string& text, const std::string& crs_wkt) {
  Polygon polygon;
  read_geometries(text, {"POLYGON", "MULTIPOLYGON"}, "POLYGON((x y, x y, x y, x y))", crs_wkt,
                  [&](const OGRGeometry& geometry) { add_geometry(geometry, polygon); });
  if (polygon.rings.empty()) {
    const std::string where = text.size() > 64 ? text.substr(0, 64) + "..." : text;
    throw Error(ErrorCode::invalid_argument, "holds no polygon", where);
  }
  return polygon;
}

}  // namespace ptin::tools
