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
#include "tools/gdal/gdal_faces.h"
#include "tools/gdal/open_options.h"

namespace ptin::tools {

/// Not one of GDAL's datasets with files beside them (.aux.xml), which would outlive a terrain that
/// is built anew. Threads: one at a time, as GDAL has it.
class TerrainDataset final : public DatasetFace {
 public:
  /// Opens a terrain, here or elsewhere (engine/remote/remote_file.h). A library takes no signals, so
  /// it is read and not mapped; and a GIS keeps files open for days, so it answers what it held.
  /// @throws Error as Terrain's and open_remote_store(); invalid_argument for options
  explicit TerrainDataset(const GDALOpenInfo& info);

  const OGRSpatialReference* GetSpatialRef() const override {
    return srs_->IsEmpty() != 0 ? nullptr : srs_.get();
  }

  [[nodiscard]] const Terrain& terrain() const noexcept { return terrain_; }
  [[nodiscard]] const StoreFacts& facts() const noexcept { return terrain_.store().facts(); }
  [[nodiscard]] const CrsFacts& crs() const noexcept { return crs_; }
  [[nodiscard]] const OpenOptions& options() const noexcept { return options_; }
  /// The pixels of the full raster: their lattice, and how many there are.
  [[nodiscard]] const RasterRequest& pixels() const noexcept { return pixels_; }
  /// The box of the samples, map units.
  [[nodiscard]] Window bounds() const noexcept;

  /// The TIN for pixels of a width and a height, map units: of as many vertices, and borders of voids within
  /// a quarter of a pixel. It is the same for all windows, so that blocks of a raster fit together.
  [[nodiscard]] DetailRequest detail_for_pixels(double width, double height) const;
  /// How far the TIN at a level can be from the source. `detail` names no number of vertices.
  [[nodiscard]] Certificate certificate_of(const DetailRequest& detail) const;

 private:
  [[nodiscard]] std::array<double, 6> geotransform() const override;
  [[nodiscard]] int layer_count() const override { return static_cast<int>(layers_.size()); }
  [[nodiscard]] OGRLayer* layer(int i) const override;

  struct ReleaseSrs {
    void operator()(OGRSpatialReference* srs) const noexcept { srs->Release(); }
  };

  Terrain terrain_;
  CrsFacts crs_;
  OpenOptions options_;
  std::array<double, 2> own_pixel_;  ///< Width and height of a pixel that has one sample, about.
  std::array<double, 2>
      border_reach_;  ///< How far an error of 1 moves borders of voids, map units.
  RasterRequest pixels_;
  /// The CRS counts who holds it, and outlives the dataset where layers or geometries handed it out.
  std::unique_ptr<OGRSpatialReference, ReleaseSrs> srs_;
  std::vector<std::unique_ptr<OGRLayer>> layers_;
};

/// The domain of metadata about the TIN that is looked at. GDAL's programs copy those without a domain
/// to what they make, at any size, of which nothing is certified.
inline constexpr const char* kOwnDomain = "PTIN";

/// Writes CERTIFIED_ERROR, at every sample, and CERTIFIED_DEVIATION, at any point, in the height's
/// unit. An item that stays is not touched, since GDAL lends it.
void tell_certificate(const Certificate& certificate, GDALMajorObject& object);

}  // namespace ptin::tools
