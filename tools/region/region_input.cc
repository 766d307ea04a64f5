// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/region_input.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include <gdal_priv.h>
#include <ogr_geometry.h>
#include <ogrsf_frmts.h>

#include "engine/error.h"

namespace ptin::tools {

namespace {

bool starts_with_polygon(const std::string& text) {
  std::string start;
  for (const char c : text.substr(0, 64)) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0)
      start += static_cast<char>(std::toupper(c));
  }
  return start.starts_with("POLYGON") || start.starts_with("MULTIPOLYGON");
}

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

Polygon polygon_of_wkt(const std::string& wkt, const std::string& where) {
  OGRGeometry* raw = nullptr;
  const OGRErr status = OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &raw);
  const std::unique_ptr<OGRGeometry> geometry(raw);
  Polygon polygon;
  if (status == OGRERR_NONE && geometry) add_geometry(*geometry, polygon);
  if (polygon.rings.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "not a polygon in WKT; write POLYGON((x y, x y, x y, x y))", where);
  }
  return polygon;
}

std::unique_ptr<OGRCoordinateTransformation> transformation(const OGRLayer& layer,
                                                            const std::string& crs_wkt,
                                                            const std::string& path) {
  const OGRSpatialReference* from = const_cast<OGRLayer&>(layer).GetSpatialRef();
  if (from == nullptr || crs_wkt.empty()) return nullptr;
  OGRSpatialReference source(*from);
  OGRSpatialReference target;
  if (target.importFromWkt(crs_wkt.c_str()) != OGRERR_NONE) return nullptr;
  target.DemoteTo2D(nullptr);
  target.StripVertical();
  source.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  target.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (source.IsSame(&target) != 0) return nullptr;
  std::unique_ptr<OGRCoordinateTransformation> made(
      OGRCreateCoordinateTransformation(&source, &target));
  if (!made) {
    throw Error(
        ErrorCode::invalid_argument,
        "its CRS cannot be transformed to the terrain's; give the polygon in the terrain's CRS",
        path);
  }
  return made;
}

Polygon polygon_of_file(const std::string& path, const std::string& crs_wkt) {
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(
      path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  OGRLayer* layer = data ? data->GetLayer(0) : nullptr;
  if (layer == nullptr) {
    throw Error(ErrorCode::invalid_argument, "neither WKT nor a vector file that GDAL reads", path);
  }
  const auto transform = transformation(*layer, crs_wkt, path);
  Polygon polygon;
  layer->ResetReading();
  while (const std::unique_ptr<OGRFeature> feature{layer->GetNextFeature()}) {
    OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr) continue;
    if (transform && geometry->transform(transform.get()) != OGRERR_NONE) {
      throw Error(ErrorCode::invalid_argument,
                  "a polygon cannot be transformed to the terrain's CRS", path);
    }
    add_geometry(*geometry, polygon);
  }
  if (polygon.rings.empty()) throw Error(ErrorCode::invalid_argument, "holds no polygon", path);
  return polygon;
}

}  // namespace

Polygon read_polygon(const std::string& text, const std::string& crs_wkt) {
  if (starts_with_polygon(text)) return polygon_of_wkt(text, "--polygon");
  if (!std::filesystem::exists(text)) {
    throw Error(ErrorCode::not_found,
                "no such file, and not WKT either; write POLYGON((x y, ...)) or name a file", text);
  }
  std::ifstream in(text);
  std::ostringstream start;
  start << in.rdbuf();
  if (starts_with_polygon(start.str())) return polygon_of_wkt(start.str(), text);
  return polygon_of_file(text, crs_wkt);
}

}  // namespace ptin::tools
