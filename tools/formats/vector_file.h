// SPDX-License-Identifier: GPL-3.0-or-later
//
// A vector layer on its way out, through OGR: complete or absent.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <ogr_feature.h>

#include "engine/geometry/affine.h"
#include "tools/output/temporary_path.h"

class GDALDataset;
class OGRLayer;

namespace ptin::tools {

/// A vector format by its file extension.
struct VectorFormat {
  const char* extension;
  const char* driver;  ///< GDAL's name for it.
};
/// The extensions as "`.gpkg`, ..." for help texts.
[[nodiscard]] std::string known_vector_extensions();
/// The format of a file by its extension; null when it is none of them.
[[nodiscard]] const VectorFormat* find_vector_format(const std::string& path);
/// The format of an output; "-" is GeoJSON on stdout.
/// @throws Error invalid_argument  unknown extension
[[nodiscard]] const VectorFormat& vector_format_of(const std::string& path);

/// Refuses an output whose name ends in none of the extensions that are known.
/// @throws Error invalid_argument
[[noreturn]] void refuse_extension(const std::string& path, const std::string& known);

/// One layer in one file. It is written in a folder beside the target, and publish() renames it.
/// Destroyed without publish(), it removes what it wrote. With "-" features go to stdout as they
/// come.
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
    OGRwkbGeometryType geometry;
    std::vector<Field> fields;
    std::string crs_wkt;  ///< Empty: unknown.
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
  void add(std::unique_ptr<OGRGeometry> geometry, std::span<const Value> values);

  /// Closes the file and makes it appear under its name.
  /// @throws Error io_error, resource_exhausted, invalid_argument
  void publish();

 private:
  void close();

  std::string path_, target_;  ///< `path_` as given, for messages; `target_` where it leads.
  /// For the work; none on stdout.
  std::optional<TemporaryPath> folder_;
  bool overwrite_;
  std::string driver_;
  std::unique_ptr<GDALDataset, void (*)(GDALDataset*)> dataset_;
  OGRLayer* layer_ = nullptr;
  std::vector<int> fields_;  ///< Places of the layer's fields in a feature.
};

/// A line through map points; all of them at height `z`, unless `z` is null.
[[nodiscard]] std::unique_ptr<OGRGeometry> line_geometry(std::span<const MapPoint> points,
                                                         const double* z);

}  // namespace ptin::tools
