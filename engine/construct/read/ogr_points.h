// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of a vector layer: anything that OGR reads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/construct/grid/source_options.h"
#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"

namespace ptin {

/// The points (and multipoints) of one layer as a stream. The height is the geometry's z, or the
/// number in the attribute PointChoice::z_field, whose name may give its unit
/// (read/column_names.h). Left out are features without a geometry, hidden ones
/// (read/hidden_features.h), features in which a chosen attribute is not set, and heights below -10^38,
/// by which a shapefile says that it has none. The unit
/// of DXF is $INSUNITS, but inches, which are warned of; so are altitude modes of KML other than
/// absolute, and further geometries of a feature. Coordinates are taken as the shortest decimals that
/// read back as the same doubles, so that a layer gives the same terrain as the text that it was made
/// of.
class OgrPoints final : public PointStream {
 public:
  /// @throws Error  not_found         there is no such file
  ///                invalid_argument  OGR does not read it; as choose_layer(); no such attribute; a
  ///                                  layer without heights
  OgrPoints(std::string path, const PointChoice& choice);
  ~OgrPoints() override;

  [[nodiscard]] const PointStreamFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool next(std::vector<SourcePoint>& batch) override;
  [[nodiscard]] LeftOutPoints left_out() const noexcept override { return left_out_; }
  [[nodiscard]] SourceWarnings warnings() const override { return warnings_; }
  [[nodiscard]] std::uint64_t done() const noexcept override { return read_; }
  [[nodiscard]] std::uint64_t total() const noexcept override { return total_; }

  /// True when OGR finds a layer in the file and GDAL finds no raster. Cost: opens it up to twice.
  [[nodiscard]] static bool reads(const std::string& path);

 private:
  struct Layer;
  // OGR's types stay out of this header: a feature is an OGRFeature, a point an OGRPoint.
  void add_feature(void* feature, std::vector<SourcePoint>& batch);
  void add_point(const void* point, double field_height, std::vector<SourcePoint>& batch);
  void note_altitude_mode(const void* feature);
  void note_unit(const std::string& unit);
  void note_geodata();
  [[nodiscard]] Decimal number(double value, const char* role) const;

  std::string path_;
  std::unique_ptr<Layer> layer_;
  PointStreamFacts facts_;
  std::int64_t feature_ = 0;  ///< Number of the feature that was read last, for errors.
  std::uint64_t read_ = 0, total_ = 0;
  LeftOutPoints left_out_;
  SourceWarnings warnings_;
};

}  // namespace ptin
