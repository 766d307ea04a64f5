// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/region/vector_input.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include <cpl_error.h>
#include <ogrsf_frmts.h>

#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin::tools {

namespace {

constexpr std::size_t kLongestWord = 64;
/// What may follow the word of a geometry, without blanks.
constexpr std::array kAfterWord = {"(", "Z(", "M(", "ZM(", "EMPTY", "ZEMPTY", "MEMPTY", "ZMEMPTY"};

constexpr std::array<std::string_view, 7> kShapes = {
    "POINT",           "LINESTRING",   "POLYGON",           "MULTIPOINT",
    "MULTILINESTRING", "MULTIPOLYGON", "GEOMETRYCOLLECTION"};

/// False when nothing of this name is there. A name too long for a file names none.
bool exists(const std::string& path) {
  std::error_code fault;
  if (std::filesystem::exists(path, fault)) return true;
  if (fault && fault != std::errc::filename_too_long && fault != std::errc::not_a_directory) {
    throw system_error(fault.value(), "cannot open", path);
  }
  return false;
}

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

/// From the layer's CRS to the terrain's; null when there is nothing to do.
Transformation transformation(OGRLayer& layer, const std::string& crs_wkt,
                              const std::string& path) {
  const OGRSpatialReference* from = layer.GetSpatialRef();
  if (from == nullptr || crs_wkt.empty()) return nullptr;
  OGRSpatialReference source(*from);
  OGRSpatialReference target;
  if (target.importFromWkt(crs_wkt.c_str()) != OGRERR_NONE) return nullptr;
  for (OGRSpatialReference* plane : {&source, &target}) {
    plane->DemoteTo2D(nullptr);
    plane->StripVertical();
    plane->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  }
  if (source.IsSame(&target) != 0) return nullptr;
  Transformation made(OGRCreateCoordinateTransformation(&source, &target));
  if (!made) {
    throw Error(ErrorCode::invalid_argument,
                "its CRS cannot be transformed to the terrain's; give it in the terrain's CRS",
                path);
  }
  return made;
}

/// Brings the points, lines and rings of a geometry into another CRS.
class IntoTerrain : public OGRDefaultGeometryVisitor {
 public:
  IntoTerrain(OGRCoordinateTransformation& way, const SideTarget& sides)
      : transform_(places_by(way)), sides_(sides) {}
  using OGRDefaultGeometryVisitor::visit;

  void visit(OGRPoint* point) override {
    if (point->IsEmpty() != 0) return;
    const MapPoint at{point->getX(), point->getY()};
    const MapPoint there = transformed_sides({&at, 1}, transform_, sides_).front();
    point->setX(there.x);
    point->setY(there.y);
  }

  void visit(OGRLineString* line) override {
    std::vector<MapPoint> path;
    for (int i = 0; i < line->getNumPoints(); ++i) path.push_back({line->getX(i), line->getY(i)});
    const std::vector<MapPoint> there = transformed_sides(path, transform_, sides_);
    // Corners keep a height of their own where nothing stands between them.
    if (there.size() != path.size()) {
      line->set3D(FALSE);
      line->setNumPoints(static_cast<int>(there.size()));
    }
    for (std::size_t i = 0; i < there.size(); ++i) {
      line->setPoint(static_cast<int>(i), there[i].x, there[i].y);
    }
  }

 private:
  PlaceTransform transform_;
  const SideTarget& sides_;
};

/// Brings the geometry of a feature into a terrain's CRS. Arcs become chords in their own before.
void bring_into_terrain(OGRFeature& feature, OGRCoordinateTransformation& way,
                        const SideTarget& sides, const std::string& path) {
  if (feature.GetGeometryRef() == nullptr) return;
  if (feature.GetGeometryRef()->hasCurveGeometry() != 0) {
    feature.SetGeometryDirectly(feature.GetGeometryRef()->getLinearGeometry());
  }
  IntoTerrain visitor(way, sides);
  try {
    feature.GetGeometryRef()->accept(&visitor);
  } catch (const Error& e) {
    throw Error(e.code(),
                "feature " + std::to_string(feature.GetFID()) + ": " + e.message() +
                    "; give it in that CRS",
                path);
  }
}

/// The first bytes of a file, enough to tell WKT from other things.
std::string first_bytes(std::ifstream& in) {
  std::string start(kLongestWord, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return start;
}

/// "POINTZ(" as "POINT Z(": the standard has both, and OGR reads the blank alone.
std::string with_blanks(const std::string& wkt) {
  std::string text;
  for (std::size_t i = 0; i < wkt.size();) {
    std::size_t end = i;
    std::string word;
    for (; end < wkt.size() && std::isalpha(static_cast<unsigned char>(wkt[end])) != 0; ++end) {
      word += static_cast<char>(std::toupper(static_cast<unsigned char>(wkt[end])));
    }
    if (end == i) {
      text += wkt[i++];
      continue;
    }
    const auto splits = [&](std::string_view mark) {
      return word.ends_with(mark) &&
             std::any_of(kShapes.begin(), kShapes.end(), [&](std::string_view shape) {
               return word.size() == shape.size() + mark.size() && word.starts_with(shape);
             });
    };
    const std::size_t mark = splits("ZM") ? 2 : splits("Z") || splits("M") ? 1 : 0;
    text.append(wkt, i, end - i - mark);
    if (mark > 0) text.append(" ").append(wkt, end - mark, mark);
    i = end;
  }
  return text;
}

std::unique_ptr<OGRGeometry> wkt_or_refuse(const std::string& wkt, const std::string& example,
                                           const std::string& where) {
  std::unique_ptr<OGRGeometry> geometry = geometry_of_wkt(wkt);
  if (geometry) return geometry;
  throw Error(ErrorCode::invalid_argument, "this is no sound WKT; write it as " + example, where);
}

}  // namespace

std::unique_ptr<OGRGeometry> geometry_of_wkt(const std::string& text) {
  const std::string spaced = with_blanks(text);
  const char* rest = spaced.c_str();
  OGRGeometry* raw = nullptr;
  const OGRErr status = OGRGeometryFactory::createFromWkt(&rest, nullptr, &raw);
  std::unique_ptr<OGRGeometry> geometry(raw);
  while (std::isspace(static_cast<unsigned char>(*rest)) != 0) ++rest;
  if (status != OGRERR_NONE || *rest != '\0') geometry.reset();
  return geometry;
}

bool begins_as_wkt(const std::string& text, const std::vector<std::string>& words) {
  std::string start;
  for (const char c : text.substr(0, kLongestWord)) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isspace(byte) == 0) start += static_cast<char>(std::toupper(byte));
  }
  const auto opens = [&](std::string_view word) {
    if (!start.starts_with(word)) return false;
    const std::string_view rest = std::string_view(start).substr(word.size());
    return std::any_of(kAfterWord.begin(), kAfterWord.end(),
                       [&](const char* after) { return rest.starts_with(after); });
  };
  return std::any_of(words.begin(), words.end(), opens);
}

TerrainPlane TerrainPlane::with_corners_alone() const {
  TerrainPlane plane = *this;
  plane.sides.most_bend = HUGE_VAL;
  return plane;
}

TerrainPlane plane_of(const StoreFacts& facts, const CrsFacts& crs) {
  return {crs.wkt,
          side_target(facts, crs.geographic && crs.horizontal_unit == "degree" ? 360.0 : 0.0)};
}

std::optional<Transformed> for_each_feature(const std::string& path, const LayerWish& wish,
                                            const TerrainPlane& plane,
                                            const std::function<void(const OGRFeature&)>& visit) {
  if (!exists(path)) throw Error(ErrorCode::not_found, "no such file", path);
  const std::unique_ptr<GDALDataset> data(GDALDataset::Open(
      path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
  if (!data || data->GetLayerCount() == 0) {
    require_readable(path);
    throw Error(ErrorCode::invalid_argument,
                "neither text that is understood here nor a vector file that GDAL reads", path);
  }
  OGRLayer& layer = choose_layer(*data, wish, path);
  const Transformation transform = transformation(layer, plane.crs_wkt, path);
  SideTarget sides = plane.sides;
  sides.source_turns = transform && has_degrees(*layer.GetSpatialRef());
  CPLErrorReset();
  layer.ResetReading();
  while (const std::unique_ptr<OGRFeature> feature{layer.GetNextFeature()}) {
    if (transform) bring_into_terrain(*feature, *transform, sides, path);
    visit(*feature);
  }
  if (CPLGetLastErrorType() >= CE_Failure) {
    throw Error(ErrorCode::invalid_argument,
                std::string("cannot be read to its end: ") + CPLGetLastErrorMsg(), path);
  }
  if (!transform) return std::nullopt;
  return Transformed{layer.GetSpatialRef()->GetName(), plane.sides.most_bend};
}

std::optional<Transformed> read_geometries(
    const GeometrySource& source, const TerrainPlane& plane,
    const std::function<void(const OGRGeometry&, const OGRFeature*)>& visit) {
  const std::string& text = source.text;
  if (begins_as_wkt(text, source.words) && !exists(text)) {  // A file may be "Polygon (1).gpkg".
    visit(*wkt_or_refuse(text, source.example, ""), nullptr);
    return std::nullopt;
  }
  if (!exists(text)) {
    throw Error(ErrorCode::not_found,
                "no such file, and not the WKT that is expected here; write " + source.example +
                    " or name a file",
                text);
  }
  errno = 0;
  std::ifstream in(text);
  if (!in) throw system_error(errno, "cannot open", text);
  std::string start = first_bytes(in);
  if (begins_as_wkt(start, source.words)) {
    start.append(std::istreambuf_iterator<char>(in), {});
    visit(*wkt_or_refuse(start, source.example, text), nullptr);
    return std::nullopt;
  }
  return for_each_feature(text, source.layer, plane, [&](const OGRFeature& feature) {
    if (feature.GetGeometryRef() != nullptr) visit(*feature.GetGeometryRef(), &feature);
  });
}

}  // namespace ptin::tools
