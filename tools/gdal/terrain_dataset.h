// SPDX-License-Identifier: GPL-3.0-or-later
//
// A terrain as GDAL sees it: a raster of one band and layers of triangles and isolines, read only.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "engine/crs/crs_facts.h"
#include "engine/query/questions.h"
#include "tools/gdal/open_options.h"

namespace ptin::tools {

/// Not one of GDAL's datasets with files beside them (.aux.xml), which would outlive a terrain that
/// is built anew. Threads: one at a time, as GDAL has it.
class TerrainDataset final : public GDALDataset {
 public:
  /// Opens a terrain, here or elsewhere (engine/remote/remote_file.h). A library takes no signals, so
  /// it is read and not mapped; and a GIS keeps files open for days, so it answers what it held.
  /// @throws Error as Terrain's and open_remote_store(); invalid_argument for options
  explicit TerrainDataset(const GDALOpenInfo& info);

  CPLErr GetGeoTransform(double* transform) override;
  const OGRSpatialReference* GetSpatialRef() const override {
    return srs_.IsEmpty() != 0 ? nullptr : &srs_;
  }
  int GetLayerCount() override { return static_cast<int>(layers_.size()); }
  OGRLayer* GetLayer(int i) override;

  [[nodiscard]] const Terrain& terrain() const noexcept { return terrain_; }
  [[nodiscard]] const StoreFacts& facts() const noexcept { return terrain_.store().facts(); }
  [[nodiscard]] const CrsFacts& crs() const noexcept { return crs_; }
  [[nodiscard]] const OpenOptions& options() const noexcept { return options_; }
  /// The pixels of the full raster: their lattice, and how many there are.
  [[nodiscard]] const RasterRequest& pixels() const noexcept { return pixels_; }
  /// The box of the samples, map units.
  [[nodiscard]] Window bounds() const noexcept;

  /// The TIN for pixels of an area, square map units. It is the same for all windows, so that blocks of
  /// a raster fit together.
  [[nodiscard]] DetailRequest detail_for_pixels(double area) const;

 private:
  Terrain terrain_;
  CrsFacts crs_;
  OpenOptions options_;
  std::array<double, 2> own_pixel_;  ///< Width and height of a pixel that has one sample, about.
  RasterRequest pixels_;
  OGRSpatialReference srs_;
  std::vector<std::unique_ptr<OGRLayer>> layers_;
};

}  // namespace ptin::tools
