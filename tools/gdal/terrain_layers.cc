// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/gdal/terrain_layers.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "tools/gdal/guard.h"
#include "tools/gdal/terrain_dataset.h"

namespace ptin::tools {

namespace {

/// About how many vertices the layer of triangles has without ERROR: a map shows no more.
constexpr std::uint64_t kVerticesOfLayer = 50'000;
/// A cell of isolines has a record for so many bytes of MEMORY_MB, at most: 16 million by default, whose
/// lines take a second or two.
constexpr std::uint64_t kBytesOfRecord = 64;
/// A line's number within its cell has so many bits.
constexpr int kBitsOfLine = 32;

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
  return EQUAL(capability, OLCFastGetExtent) || EQUAL(capability, OLCFastSpatialFilter) ||
         EQUAL(capability, OLCRandomRead);
}

std::optional<OGREnvelope> FoundLayer::box_of_filter() const {
  OGREnvelope box = extent();
  if (m_poFilterGeom != nullptr) box.Intersect(m_sFilterEnvelope);
  return box.IsInit() ? std::optional(box) : std::nullopt;
}

void FoundLayer::renew_metadata(const char* domain) {
  if (domain == nullptr || !EQUAL(domain, kOwnDomain)) return;
  static_cast<void>(guarded([&] { tell_certificate(dataset_.certificate_of(detail()), *this); }));
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
  const bool is_read = guarded([&] {
    if (!find_in_filter()) return;
    while (next_ < size() && !may_meet(next_, *found_)) ++next_;
    if (next_ >= size()) return;
    next = feature(next_);
    ++next_;
  });
  has_failed_ = has_failed_ || !is_read;
  return next.release();
}

GIntBig FoundLayer::GetFeatureCount(int is_forced) {
  if (is_forced == FALSE) return -1;
  // GDAL's own would count what comes before a failure.
  ResetReading();
  GIntBig count = 0;
  while (const std::unique_ptr<OGRFeature> next{GetNextFeature()}) ++count;
  const bool is_whole = !has_failed_;
  ResetReading();
  return is_whole ? count : -1;
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

DetailRequest TriangleLayer::detail() const {
  if (dataset().options().error) return detail_of(dataset().options().error);
  IoCounters io;
  return detail_for(dataset().terrain().store(), kVerticesOfLayer, dataset().bounds(), io);
}

void TriangleLayer::find(const Window& window) {
  surface_.clear();
  const StoreFile& store = dataset().terrain().store();
  PartRequest request;
  request.region = window;
  request.limits.memory_bytes = dataset().options().memory_bytes;
  request.detail = detail();
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
  set_cells();
}

DetailRequest IsolineLayer::detail() const { return detail_of(dataset().options().error); }

void IsolineLayer::set_cells() {
  const Window all = dataset().bounds();
  const std::uint64_t records =
      records_above(dataset().terrain().store(), detail().tolerance.value_or(-1.0));
  const std::uint64_t most = dataset().options().memory_bytes / kBytesOfRecord;
  while (records / static_cast<std::uint64_t>(columns_ * rows_) > most) {
    const double width = (all.max_x - all.min_x) / static_cast<double>(columns_);
    const double height = (all.max_y - all.min_y) / static_cast<double>(rows_);
    (width >= height ? columns_ : rows_) *= 2;
  }
}

Window IsolineLayer::window_of_cell(std::int64_t cell) const {
  const Window all = dataset().bounds();
  const auto side = [](double from, double to, std::int64_t i, std::int64_t of) {
    return std::lerp(from, to, static_cast<double>(i) / static_cast<double>(of));
  };
  const std::int64_t column = cell % columns_, row = cell / columns_;
  return {side(all.min_x, all.max_x, column, columns_), side(all.min_y, all.max_y, row, rows_),
          side(all.min_x, all.max_x, column + 1, columns_),
          side(all.min_y, all.max_y, row + 1, rows_)};
}

std::vector<std::int64_t> IsolineLayer::cells_in(const Window& window) const {
  std::vector<std::int64_t> cells;
  for (std::int64_t cell = 0; cell < columns_ * rows_; ++cell) {
    const Window w = window_of_cell(cell);
    if (w.min_x <= window.max_x && w.min_y <= window.max_y && w.max_x >= window.min_x &&
        w.max_y >= window.min_y) {
      cells.push_back(cell);
    }
  }
  return cells;
}

void IsolineLayer::find(const Window& window) { find_cells(cells_in(window)); }

void IsolineLayer::find_cells(const std::vector<std::int64_t>& cells) {
  const auto is_cell = [](const CellLines& lines, std::int64_t cell) { return lines.cell == cell; };
  if (std::equal(cells_.begin(), cells_.end(), cells.begin(), cells.end(), is_cell)) return;
  cells_.clear();
  const OpenOptions& options = dataset().options();
  const StoreFacts& facts = dataset().facts();
  IsolineRequest request;
  request.levels = levels_at(*options.interval, 0.0, facts.min_height, facts.max_height);
  if (request.levels.empty()) return;
  request.limits.memory_bytes = options.memory_bytes;
  request.detail = detail();
  std::error_code missing;  // without a folder no file is made: points are to fit into memory
  request.temporary_folder = std::filesystem::temp_directory_path(missing).string();
  for (const std::int64_t cell : cells) {
    request.region = window_of_cell(cell);
    const std::size_t first = size();
    cells_.push_back({cell, first, dataset().terrain().isolines(request)});
  }
}

std::size_t IsolineLayer::size() const {
  return cells_.empty() ? 0 : cells_.back().first + cells_.back().lines.size();
}

IsolineLayer::Place IsolineLayer::place_of(std::size_t i) const {
  const auto after =
      std::upper_bound(cells_.begin(), cells_.end(), i,
                       [](std::size_t line, const CellLines& lines) { return line < lines.first; });
  const CellLines& cell = *(after - 1);
  return {cell, i - cell.first};
}

GIntBig IsolineLayer::number(std::size_t i) const {
  const Place place = place_of(i);
  return (place.cell.cell << kBitsOfLine) + static_cast<GIntBig>(place.line);
}

std::unique_ptr<OGRFeature> IsolineLayer::feature_elsewhere(GIntBig wanted) {
  const std::int64_t cell = wanted >> kBitsOfLine;
  if (wanted < 0 || cell >= columns_ * rows_) return nullptr;
  if (!beside_) beside_ = std::make_unique<IsolineLayer>(dataset());
  beside_->find_cells({cell});
  return beside_->found_feature(wanted);
}

bool IsolineLayer::may_meet(std::size_t i, const OGREnvelope& box) const {
  const Place place = place_of(i);
  std::vector<MapPoint> points;
  OGREnvelope around;
  for (const MapPoint& p : place.cell.lines.line(place.line, points).points) around.Merge(p.x, p.y);
  return around.Intersects(box) != 0;
}

void IsolineLayer::fill(std::size_t i, OGRFeature& feature) const {
  const Place place = place_of(i);
  std::vector<MapPoint> points;
  const Isoline line = place.cell.lines.line(place.line, points);
  const double height = place.cell.lines.levels()[line.level];
  auto geometry = std::make_unique<OGRLineString>();
  geometry->setNumPoints(static_cast<int>(line.points.size()), FALSE);
  for (std::size_t k = 0; k < line.points.size(); ++k) {
    geometry->setPoint(static_cast<int>(k), line.points[k].x, line.points[k].y, height);
  }
  feature.SetGeometryDirectly(geometry.release());
  feature.SetField(0, height);
}

}  // namespace ptin::tools
