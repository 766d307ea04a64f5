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

/// The rings of a geometry's polygons; they are told apart by nesting alone (even-odd).
Polygon rings_of(const OGRGeometry& geometry) {
  Polygon polygon;
  for_each_polygon(geometry, [&](const OGRPolygon& part) {
    for (const OGRLinearRing* ring : part) add_ring(*ring, polygon);
  });
  return polygon;
}

/// The polygon of all that any feature covers. Each feature counts by even-odd: that is what GEOS
/// makes of a feature whose rings cross.
Polygon united(const std::vector<std::unique_ptr<OGRMultiPolygon>>& features,
               const std::string& text) {
  OGRMultiPolygon all;
  for (const auto& feature : features) {
    const std::unique_ptr<OGRGeometry> valid(feature->IsValid() ? nullptr : feature->MakeValid());
    for_each_polygon(valid ? *valid : *feature, [&](const OGRPolygon& p) { all.addGeometry(&p); });
  }
  const std::unique_ptr<OGRGeometry> one(all.UnionCascaded());
  if (!one) {
    throw Error(ErrorCode::invalid_argument,
                "its polygons cannot be united; make each of them valid by 'ogr2ogr -makevalid'",
                text);
  }
  return rings_of(*one);
}

}  // namespace

AskedPolygon read_polygon(const std::string& text, const TerrainPlane& plane) {
  AskedPolygon asked;
  std::vector<std::unique_ptr<OGRMultiPolygon>> features;
  const GeometrySource source{
      text,
      {"POLYGON", "MULTIPOLYGON"},
      "POLYGON((x y, x y, x y, x y))",
      {LayerKind::kAreas, "", "take one out by 'ogr2ogr ONE.gpkg FILE LAYER'"}};
  const auto add = [&](const OGRGeometry& geometry, const OGRFeature*) {
    auto feature = std::make_unique<OGRMultiPolygon>();
    for_each_polygon(geometry, [&](const OGRPolygon& p) { feature->addGeometry(&p); });
    if (!feature->IsEmpty()) features.push_back(std::move(feature));
  };
  asked.transformed = read_geometries(source, plane, add);
  Polygon& polygon = asked.polygon;
  if (features.size() == 1) {
    polygon = rings_of(*features.front());
  } else if (!features.empty()) {
    polygon = united(features, text);
  }
  if (polygon.rings.empty()) {
    const std::string where = text.size() > 64 ? text.substr(0, 64) + "..." : text;
    throw Error(ErrorCode::invalid_argument, "holds no polygon", where);
  }
  return asked;
}

}  // namespace ptin::tools
