// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/formats/vector_file.h"

#include <array>
#include <utility>

#include "engine/error.h"
#include "tools/formats/layer_writer.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

namespace {

constexpr std::array<VectorFormat, 4> kVectorFormats = {{{"gpkg", "GPKG"},
                                                         {"fgb", "FlatGeobuf"},
                                                         {"geojson", "GeoJSON", false},
                                                         {"shp", "ESRI Shapefile"}}};
constexpr const VectorFormat& kGeoJson = kVectorFormats[2];

}  // namespace

std::string known_vector_extensions() {
  std::string known;
  for (const VectorFormat& f : kVectorFormats)
    known.append(known.empty() ? "." : ", .").append(f.extension);
  return known;
}

const VectorFormat* find_vector_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".json") return &kGeoJson;
  for (const VectorFormat& f : kVectorFormats) {
    if (extension == std::string(".").append(f.extension)) return &f;
  }
  return nullptr;
}

bool is_geojson(const std::string& path) {
  return path == "-" || find_vector_format(path) == &kGeoJson;
}

void refuse_extension(const std::string& path, const std::string& known) {
  const std::string extension = lower_extension(path);
  const std::string what = extension.empty() ? std::string("the name has no extension")
                                             : std::string("unknown extension ").append(extension);
  refuse(what + "; known are " + known + ", and - for GeoJSON on stdout", path);
}

const VectorFormat& vector_format_of(const std::string& path) {
  if (path == "-") return kGeoJson;
  if (const VectorFormat* format = find_vector_format(path)) return *format;
  refuse_extension(path, known_vector_extensions());
}

Geometry point_geometry(MapPoint point) { return {{point}, {}, {1}}; }

Geometry point_geometry(MapPoint point, double z) { return {{point}, {z}, {1}}; }

Geometry line_geometry(std::span<const MapPoint> points, const double* z) {
  Geometry line{{points.begin(), points.end()}};
  if (z != nullptr) line.heights.assign(points.size(), *z);
  line.end_path();
  return line;
}

VectorFile::VectorFile(std::string path, bool overwrite, const Layer& layer) {
  const std::string driver = layer.driver != nullptr ? layer.driver : vector_format_of(path).driver;
  writer_ = driver == kGeoJson.driver ? make_geojson_writer(path, overwrite, layer)
                                      : make_ogr_writer(path, overwrite, layer, driver);
}

VectorFile::~VectorFile() = default;

void VectorFile::add(const Geometry& geometry, std::span<const Value> values) {
  writer_->add(geometry, values);
}

void VectorFile::publish() { writer_->publish(); }

}  // namespace ptin::tools
