// SPDX-License-Identifier: GPL-3.0-or-later
//
// A vector layer on its way out: complete or absent. GeoJSON is written here, all else by OGR.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/crs/crs_facts.h"
#include "engine/geometry/affine.h"

namespace ptin::tools {

/// A vector format by its file extension.
struct VectorFormat {
  const char* extension;
  const char* driver;  ///< GDAL's name for it.
  bool is_by_gdal = true;
};
/// The extensions as "`.gpkg`, ..." for help texts.
[[nodiscard]] std::string known_vector_extensions();
/// The format of a file by its extension; null when it is none of them.
[[nodiscard]] const VectorFormat* find_vector_format(const std::string& path);
/// True for GeoJSON, which "-" on stdout is too.
[[nodiscard]] bool is_geojson(const std::string& path);
/// The format of an output; "-" is GeoJSON on stdout.
/// @throws Error invalid_argument  unknown extension
[[nodiscard]] const VectorFormat& vector_format_of(const std::string& path);

/// Refuses an output whose name ends in none of the extensions that are known.
/// @throws Error invalid_argument
[[noreturn]] void refuse_extension(const std::string& path, const std::string& known);

/// The kind of every geometry of a layer; with heights where the name ends in Z.
enum class GeometryKind : std::uint8_t {
  kPoint,
  kPointZ,
  kLine,
  kLineZ,
  kMultiLineZ,
  kMultiPolygon
};

/// A geometry as the paths that it consists of: a point alone, lines, closed rings.
struct Geometry {
  std::vector<MapPoint> points{};    ///< Those of the first path, of the second, ...
  std::vector<double> heights{};     ///< One a point where the kind has them.
  std::vector<std::size_t> paths{};  ///< For each path how many points it and those before it have.
  /// For each polygon how many paths it and those before it have: its outline, then its holes.
  std::vector<std::size_t> polygons{};

  /// Ends the path that the last points belong to.
  void end_path() { paths.push_back(points.size()); }
};
[[nodiscard]] Geometry point_geometry(MapPoint point);
[[nodiscard]] Geometry point_geometry(MapPoint point, double z);
/// A line; all of it at height `z`, unless `z` is null.
[[nodiscard]] Geometry line_geometry(std::span<const MapPoint> points, const double* z);

class LayerWriter;

/// One layer in one file, which appears under its name when it is published. Destroyed without
/// that, it removes what it wrote. With "-" features go to stdout as they come.
class VectorFile {
 public:
  /// kInteger has 64 bits, but in a shapefile, which keeps digits, 18 digits and a sign. kFlag is 0
  /// or 1, kBoolean true or false where the format knows them.
  enum class FieldType { kInteger, kFlag, kReal, kText, kBoolean };
  struct Field {
    std::string name;
    FieldType type;
  };
  struct Layer {
    const char* name;
    GeometryKind geometry;
    std::vector<Field> fields;
    CrsFacts crs;
    /// GDAL's name of a format that only some layers fit, as DXF; null: by the file's extension.
    const char* driver = nullptr;
    std::vector<std::string> creation{};  ///< Options of that driver, as "NAME=VALUE".
  };
  /// A number that is infinite or unknown leaves its field null.
  using Value = std::variant<std::int64_t, double, std::string>;

  /// A field that the format has of itself (as DXF its `Layer`) is the layer's own.
  /// @throws Error as check_output; io_error when GDAL cannot create the file
  VectorFile(std::string path, bool overwrite, const Layer& layer);
  VectorFile(const VectorFile&) = delete;
  VectorFile& operator=(const VectorFile&) = delete;
  ~VectorFile();

  /// Adds a feature; `values` in the order of the layer's fields.  @throws Error io_error
  void add(const Geometry& geometry, std::span<const Value> values);

  /// Closes the file and makes it appear under its name.
  /// @throws Error io_error, resource_exhausted, invalid_argument
  void publish();

 private:
  std::unique_ptr<LayerWriter> writer_;
};

}  // namespace ptin::tools
