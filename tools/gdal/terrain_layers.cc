// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/terrain_layers.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/gdal/guard.h"
#include "tools/gdal/terrain_dataset.h"

namespace ptin::tools {

namespace {

/// About how many vertices meet the filter of a layer of triangles: a map shows no more.
constexpr std::uint64_t kVerticesOfLayer = 50'000;

/// A number for a triangle by its place: no two of a TIN have one centre.
GIntBig number_of(const std::array<GridPoint, 3>& corners, const GridBox& bounds) {
  std::uint64_t x = 0;
  std::uint64_t y = 0;
  for (const GridPoint& p : corners) {
    x += static_cast<std::uint64_t>(p.x - bounds.min_x);
    y += static_cast<std::uint64_t>(p.y - bounds.min_y);
  }
  const std::uint64_t row = 3 * static_cast<std::uint64_t>(bounds.max_x - bounds.min_x) + 1;
  return static_cast<GIntBig>((y * row + x) & 0x7FFF'FFFF'FFFF'FFFF);
}

}  // namespace

FoundLayer::FoundLayer(const TerrainDataset& dataset, const char* name, OGRwkbGeometryType type)
    : dataset_(dataset), definition_(new OGRFeatureDefn(name)) {
  SetDescription(name);
  definition_->Reference();
  definition_->SetGeomType(type);
  // GDAL 3.6 takes a pointer to what it copies.
  definition_->GetGeomFieldDefn(0)->SetSpatialRef(
      const_cast<OGRSpatialReference*>(dataset.GetSpatialRef()));
}

OGRErr FoundLayer::GetExtent(OGREnvelope* extent, int /*is_forced*/) {
  const Window bounds = dataset_.bounds();
  extent->MinX = bounds.min_x, extent->MinY = bounds.min_y;
  extent->MaxX = bounds.max_x, extent->MaxY = bounds.max_y;
  return OGRERR_NONE;
}

int FoundLayer::TestCapability(const char* capability) {
  return static_cast<int>(EQUAL(capability, OLCFastGetExtent) ||
                          EQUAL(capability, OLCFastSpatialFilter));
}

OGRFeature* FoundLayer::GetNextRawFeature() {
  std::unique_ptr<OGRFeature> feature;
  static_cast<void>(guarded([&] {
    OGREnvelope box;
    GetExtent(&box, TRUE);
    if (m_poFilterGeom != nullptr) box.Intersect(m_sFilterEnvelope);
    if (!box.IsInit()) return;  // the filter lies elsewhere
    if (found_ != box) {
      found_.reset();
      find({box.MinX, box.MinY, box.MaxX, box.MaxY});
      found_ = box;
      next_ = 0;
    }
    if (next_ >= size()) return;
    feature = std::make_unique<OGRFeature>(definition_);
    fill(next_, *feature);
    feature->GetGeometryRef()->assignSpatialReference(
        definition_->GetGeomFieldDefn(0)->GetSpatialRef());
    ++next_;
  }));
  return feature.release();
}

void TriangleLayer::find(const Window& window) {
  surface_.clear();
  const OpenOptions& options = dataset().options();
  const StoreFile& store = dataset().terrain().store();
  PartRequest request;
  request.region = window;
  request.limits.memory_bytes = options.memory_bytes;
  IoCounters io;
  if (!options.error) {
    request.detail = detail_for(store, kVerticesOfLayer, window, io);
  } else if (*options.error > 0) {
    request.detail.tolerance = options.error;
  }
  parts_ = dataset().terrain().parts(request);
  tin_ = parts_->part(store.facts().bounds);
  if (tin_ == nullptr) {
    throw Error(ErrorCode::resource_exhausted,
                "the triangles take more than MEMORY_MB: give more, a larger ERROR or a filter",
                store.path());
  }
  for (TriangleId t = 0; t < tin_->triangles.size(); ++t) {
    if (tin_->is_alive(t) && tin_->classes[t] == TriangleClass::kSurface) surface_.push_back(t);
  }
}

void TriangleLayer::fill(std::size_t i, OGRFeature& feature) const {
  const StoreFacts& facts = dataset().facts();
  std::array<GridPoint, 3> corners;
  OGRLinearRing ring;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vertex& vertex = tin_->vertices[tin_->triangles[surface_[i]].v[k]];
    corners[k] = vertex.position;
    const MapPoint at = facts.map.to_map(vertex.position.x, vertex.position.y);
    ring.addPoint(at.x, at.y, facts.heights.height(vertex.height));
  }
  ring.closeRings();
  auto polygon = std::make_unique<OGRPolygon>();
  polygon->addRing(&ring);
  feature.SetGeometryDirectly(polygon.release());
  feature.SetFID(number_of(corners, facts.bounds));
}

IsolineLayer::IsolineLayer(const TerrainDataset& dataset)
    : FoundLayer(dataset, "isolines", wkbLineString25D) {
  OGRFieldDefn field("elev", OFTReal);
  GetLayerDefn()->AddFieldDefn(&field);
}

void IsolineLayer::find(const Window& window) {
  lines_.reset();
  const OpenOptions& options = dataset().options();
  const StoreFacts& facts = dataset().facts();
  IsolineRequest request;
  request.levels = levels_at(*options.interval, 0.0, facts.min_height, facts.max_height);
  if (request.levels.empty()) return;
  request.region = window;
  request.limits.memory_bytes = options.memory_bytes;
  if (options.error.value_or(0) > 0) request.detail.tolerance = options.error;
  lines_ = dataset().terrain().isolines(request);
}

void IsolineLayer::fill(std::size_t i, OGRFeature& feature) const {
  std::vector<MapPoint> points;
  const Isoline line = lines_->line(i, points);
  const double height = lines_->levels()[line.level];
  auto geometry = std::make_unique<OGRLineString>();
  geometry->setNumPoints(static_cast<int>(line.points.size()), FALSE);
  for (std::size_t k = 0; k < line.points.size(); ++k) {
    geometry->setPoint(static_cast<int>(k), line.points[k].x, line.points[k].y, height);
  }
  feature.SetGeometryDirectly(geometry.release());
  feature.SetField(0, height);
  feature.SetFID(static_cast<GIntBig>(i));
}

}  // namespace ptin::tools
