// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ways of writing a layer.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "tools/formats/vector_file.h"

namespace ptin::tools {

/// A way of writing a layer, behind VectorFile, which says what the functions do.
class LayerWriter {
 public:
  LayerWriter() = default;
  LayerWriter(const LayerWriter&) = delete;
  LayerWriter& operator=(const LayerWriter&) = delete;
  virtual ~LayerWriter() = default;

  virtual void add(const Geometry& geometry, std::span<const VectorFile::Value> values) = 0;
  virtual void publish() = 0;
};

/// GeoJSON (RFC 7946 but for its CRS, which is named as GDAL does). Coordinates are as short as
/// reads back to the same bits; a real number has a point, by which readers know its type.
[[nodiscard]] std::unique_ptr<LayerWriter> make_geojson_writer(const std::string& path,
                                                               bool overwrite,
                                                               const VectorFile::Layer& layer);
/// By GDAL's driver of this name.
[[nodiscard]] std::unique_ptr<LayerWriter> make_ogr_writer(const std::string& path, bool overwrite,
                                                           const VectorFile::Layer& layer,
                                                           const std::string& driver);

}  // namespace ptin::tools
