// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/terrain_layers.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/gdal/guard.h"
#include "tools/gdal/terrain_dataset.h"

namespace ptin::tools {

namespace {

/// About how many vertices meet the filter of a layer of triangles: a map shows no more.
constexpr std::uint64_t kVerticesOfLayer = 50'000;

/// How many thirds of a grid unit, where centres of triangles lie, a row of the terrain has.
GIntBig numbers_of_row(const GridBox& bounds) {
  return 3 * (GIntBig{bounds.max_x} - bounds.min_x) + 1;
}

Window window_of(const OGREnvelope& box) { return {box.MinX, box.MinY, box.MaxX, box.MaxY}; }

/// The level of an error; of 0 or none the full TIN.
DetailRequest detail_of(const std::optional<double>& error) {
  DetailRequest detail;
  if (error.value_or(0) > 0) detail.tolerance = error;
  return detail;
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

OGREnvelope FoundLayer::extent() const {
  const Window bounds = dataset_.bounds();
  OGREnvelope box;
  box.MinX = bounds.min_x, box.MinY = bounds.min_y;
  box.MaxX = bounds.max_x, box.MaxY = bounds.max_y;
  return box;
}

bool FoundLayer::is_able(const char* capability) const {
  return EQUAL(capability, OLCFastGetExtent) || EQUAL(capability, OLCFastSpatialFilter);
}

std::optional<OGREnvelope> FoundLayer::box_of_filter() const {
  OGREnvelope box = extent();
  if (m_poFilterGeom != nullptr) box.Intersect(m_sFilterEnvelope);
  return box.IsInit() ? std::optional(box) : std::nullopt;
}

void FoundLayer::renew_metadata(const char* domain) {
  if (domain == nullptr || !EQUAL(domain, kOwnDomain)) return;
  static_cast<void>(guarded([&] {
    const OGREnvelope box = box_of_filter().value_or(extent());
    tell_certificate(dataset_.certificate_of(detail(window_of(box))), *this);
  }));
}

bool FoundLayer::find_in_filter() {
  const std::optional<OGREnvelope> box = box_of_filter();
  if (!box) return false;
  if (found_ == box) return true;
  found_.reset();
  find(window_of(*box));
  found_ = box;
  next_ = 0;
  return true;
}

std::unique_ptr<OGRFeature> FoundLayer::feature(std::size_t i) const {
  auto result = std::make_unique<OGRFeature>(definition_);
  fill(i, *result);
  result->SetFID(number(i));
  result->GetGeometryRef()->assignSpatialReference(
      definition_->GetGeomFieldDefn(0)->GetSpatialRef());
  return result;
}

OGRFeature* FoundLayer::GetNextRawFeature() {
  std::unique_ptr<OGRFeature> next;
  static_cast<void>(guarded([&] {
    if (!find_in_filter() || next_ >= size()) return;
    next = feature(next_);
    ++next_;
  }));
  return next.release();
}

OGRFeature* FoundLayer::GetFeature(GIntBig wanted) {
  std::unique_ptr<OGRFeature> known;
  static_cast<void>(guarded([&] {
    if (found_) known = found_feature(wanted);
    if (!known) known = feature_elsewhere(wanted);
    if (!known && !found_ && find_in_filter()) known = found_feature(wanted);
  }));
  return known.release();
}

std::unique_ptr<OGRFeature> FoundLayer::found_feature(GIntBig wanted) const {
  for (std::size_t i = 0; i < size(); ++i) {
    if (number(i) == wanted) return feature(i);
  }
  return nullptr;
}

DetailRequest TriangleLayer::detail(const Window& window) const {
  if (dataset().options().error) return detail_of(dataset().options().error);
  IoCounters io;
  return detail_for(dataset().terrain().store(), kVerticesOfLayer, window, io);
}

void TriangleLayer::find(const Window& window) {
  surface_.clear();
  const StoreFile& store = dataset().terrain().store();
  PartRequest request;
  request.region = window;
  request.limits.memory_bytes = dataset().options().memory_bytes;
  request.detail = detail(window);
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

std::unique_ptr<OGRFeature> TriangleLayer::feature_elsewhere(GIntBig wanted) {
  const GridBox& bounds = dataset().facts().bounds;
  const GIntBig row = numbers_of_row(bounds);
  if (wanted < 0 || wanted / row > 3 * (GIntBig{bounds.max_y} - bounds.min_y)) return nullptr;
  const double x = bounds.min_x + static_cast<double>(wanted % row) / 3;
  const double y = bounds.min_y + static_cast<double>(wanted / row) / 3;
  const MapPoint low = dataset().facts().map.to_map(x - 0.5, y - 0.5);
  const MapPoint high = dataset().facts().map.to_map(x + 0.5, y + 0.5);
  TriangleLayer there(dataset());
  there.find({low.x, low.y, high.x, high.y});
  return there.found_feature(wanted);
}

/// By its place: no two triangles of a TIN have one centre.
GIntBig TriangleLayer::number(std::size_t i) const {
  const GridBox& bounds = dataset().facts().bounds;
  std::uint64_t x = 0;
  std::uint64_t y = 0;
  for (const VertexId v : tin_->triangles[surface_[i]].v) {
    const GridPoint& p = tin_->vertices[v].position;
    x += static_cast<std::uint64_t>(p.x - bounds.min_x);
    y += static_cast<std::uint64_t>(p.y - bounds.min_y);
  }
  const auto row = static_cast<std::uint64_t>(numbers_of_row(bounds));
  return static_cast<GIntBig>((y * row + x) & 0x7FFF'FFFF'FFFF'FFFF);
}

void TriangleLayer::fill(std::size_t i, OGRFeature& feature) const {
  const StoreFacts& facts = dataset().facts();
  OGRLinearRing ring;
  for (const VertexId v : tin_->triangles[surface_[i]].v) {
    const Vertex& vertex = tin_->vertices[v];
    const MapPoint at = facts.map.to_map(vertex.position.x, vertex.position.y);
    ring.addPoint(at.x, at.y, facts.heights.height(vertex.height));
  }
  ring.closeRings();
  auto polygon = std::make_unique<OGRPolygon>();
  polygon->addRing(&ring);
  feature.SetGeometryDirectly(polygon.release());
}

IsolineLayer::IsolineLayer(const TerrainDataset& dataset)
    : FoundLayer(dataset, "isolines", wkbLineString25D) {
  OGRFieldDefn field("elev", OFTReal);
  definition().AddFieldDefn(&field);
}

DetailRequest IsolineLayer::detail(const Window& /*window*/) const {
  return detail_of(dataset().options().error);
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
  request.detail = detail(window);
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
}

}  // namespace ptin::tools
