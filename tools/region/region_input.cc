// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/region_input.h"

#include <functional>
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

/// Hands every polygon of a geometry to `visit`, curves as chords.
void for_each_polygon(const OGRGeometry& geometry,
                      const std::function<void(const OGRPolygon&)>& visit) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    visit(*geometry.toPolygon());
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection) != 0) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) for_each_polygon(*part, visit);
  } else if (type == wkbCurvePolygon) {
    const std::unique_ptr<OGRGeometry> linear(geometry.getLinearGeometry());
    for_each_polygon(*linear, visit);
  }
}

/// Its rings by nesting alone: even-odd.
Polygon rings_of(const OGRGeometry& geometry) {
  Polygon polygon;
  for_each_polygon(geometry, [&](const OGRPolygon& part) {
    for (const OGRLinearRing* ring : part) add_ring(*ring, polygon);
  });
  return polygon;
}

}  // namespace

Polygon read_polygon(const std::string& text, const std::string& crs_wkt) {
  OGRMultiPolygon all;
  int features = 0;
  read_geometries(text, {"POLYGON", "MULTIPOLYGON"}, "POLYGON((x y, x y, x y, x y))", crs_wkt,
                  [&](const OGRGeometry& geometry) {
                    const int before = all.getNumGeometries();
                    for_each_polygon(geometry, [&](const OGRPolygon& p) { all.addGeometry(&p); });
                    features += all.getNumGeometries() > before ? 1 : 0;
                  });
  // Features may overlap, where even-odd would leave them out.
  const std::unique_ptr<OGRGeometry> united(features > 1 ? all.UnionCascaded() : nullptr);
  if (features > 1 && !united) {
    throw Error(ErrorCode::invalid_argument,
                "its polygons cannot be united; make each of them valid by 'ogr2ogr -makevalid'",
                text);
  }
  const Polygon polygon = rings_of(united ? *united : all);
  if (polygon.rings.empty()) {
    const std::string where = text.size() > 64 ? text.substr(0, 64) + "..." : text;
    throw Error(ErrorCode::invalid_argument, "holds no polygon", where);
  }
  return polygon;
}

}  // namespace ptin::tools
