// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers as GeoJSON, a feature a line.
#include <cmath>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "tools/formats/layer_writer.h"
#include "tools/formats/number_text.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"

namespace ptin::tools {

namespace {

std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The member that names a CRS by its code; empty where it has none.
std::string crs_member(const CrsFacts& crs) {
  const std::size_t colon = crs.code.find(':');
  if (colon == std::string::npos) return {};
  std::string name = "urn:ogc:def:crs:OGC:1.3:CRS84";
  if (crs.code != "EPSG:4326" && crs.code != "OGC:CRS84") {
    name = "urn:ogc:def:crs:" + crs.code.substr(0, colon) + "::" + crs.code.substr(colon + 1);
  }
  return R"("crs": { "type": "name", "properties": { "name": )" + json_text(name) + " } },\n";
}

std::string value_text(const VectorFile::Value& value, VectorFile::FieldType type) {
  if (const auto* text = std::get_if<std::string>(&value)) return json_text(*text);
  if (const auto* number = std::get_if<double>(&value)) return nlohmann::json(*number).dump();
  const std::int64_t whole = std::get<std::int64_t>(value);
  if (type == VectorFile::FieldType::kBoolean) return whole != 0 ? "true" : "false";
  if (type == VectorFile::FieldType::kReal)
    return nlohmann::json(static_cast<double>(whole)).dump();
  return std::to_string(whole);
}

class GeoJsonWriter final : public LayerWriter {
 public:
  GeoJsonWriter(const std::string& path, bool overwrite, const VectorFile::Layer& layer)
      : kind_(layer.geometry), fields_(layer.fields) {
    if (path != "-") file_.emplace(path, overwrite);
    text_ = "{\n\"type\": \"FeatureCollection\",\n\"name\": " + json_text(layer.name) + ",\n" +
            crs_member(layer.crs) + "\"features\": [\n";
    for (const VectorFile::Field& field : fields_) names_.push_back(json_text(field.name) + ": ");
  }

  void add(const Geometry& geometry, std::span<const VectorFile::Value> values) override {
    text_ += is_empty_ ? "" : ",\n";
    is_empty_ = false;
    text_ += R"({ "type": "Feature", "properties": {)";
    for (std::size_t i = 0; i < values.size(); ++i) {
      text_.append(i == 0 ? " " : ", ").append(names_[i]);
      text_ += value_text(values[i], fields_[i].type);
    }
    text_ += R"( }, "geometry": { "type": ")";
    add_coordinates(geometry);
    text_ += " } }";
    constexpr std::size_t kManyBytes = std::size_t{1} << 16;
    if (text_.size() >= kManyBytes) write();
  }

  void publish() override {
    text_ += "\n]\n}\n";
    write();
    if (file_) file_->publish();
  }

 private:
  void write() {
    if (file_) {
      file_->write(std::string_view(text_));
    } else {
      write_to_stdout(text_);
    }
    text_.clear();
  }

  void add_coordinates(const Geometry& geometry) {
    switch (kind_) {
      case GeometryKind::kPoint:
      case GeometryKind::kPointZ:
        text_ += R"(Point", "coordinates": )";
        return add_point(geometry, 0);
      case GeometryKind::kLine:
      case GeometryKind::kLineZ:
        text_ += R"(LineString", "coordinates": )";
        return add_path(geometry, 0);
      case GeometryKind::kMultiLineZ:
        text_ += R"(MultiLineString", "coordinates": )";
        return add_paths(geometry, 0, geometry.paths.size());
      case GeometryKind::kMultiPolygon:
        text_ += R"(MultiPolygon", "coordinates": [)";
        for (std::size_t i = 0; i < geometry.polygons.size(); ++i) {
          if (i > 0) text_ += ',';
          text_ += ' ';
          add_paths(geometry, i == 0 ? 0 : geometry.polygons[i - 1], geometry.polygons[i]);
        }
        text_ += " ]";
    }
  }
  void add_paths(const Geometry& geometry, std::size_t first, std::size_t end) {
    text_ += '[';
    for (std::size_t path = first; path < end; ++path) {
      text_ += path == first ? " " : ", ";
      add_path(geometry, path);
    }
    text_ += " ]";
  }
  void add_path(const Geometry& geometry, std::size_t path) {
    text_ += '[';
    const std::size_t first = path == 0 ? 0 : geometry.paths[path - 1];
    for (std::size_t i = first; i < geometry.paths[path]; ++i) {
      text_ += i == first ? " " : ", ";
      add_point(geometry, i);
    }
    text_ += " ]";
  }
  void add_point(const Geometry& geometry, std::size_t i) {
    append_number(text_ += "[ ", geometry.points[i].x);
    append_number(text_ += ", ", geometry.points[i].y);
    if (!geometry.heights.empty()) append_number(text_ += ", ", geometry.heights[i]);
    text_ += " ]";
  }

  std::optional<OutputFile> file_;  ///< None on stdout.
  GeometryKind kind_;
  std::vector<VectorFile::Field> fields_;
  std::vector<std::string> names_;  ///< Of the fields, as members begin.
  bool is_empty_ = true;
  std::string text_;  ///< Text that is not written yet.
};

}  // namespace

std::unique_ptr<LayerWriter> make_geojson_writer(const std::string& path, bool overwrite,
                                                 const VectorFile::Layer& layer) {
  return std::make_unique<GeoJsonWriter>(path, overwrite, layer);
}

}  // namespace ptin::tools
