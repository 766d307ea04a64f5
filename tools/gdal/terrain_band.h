// SPDX-License-Identifier: GPL-3.0-or-later
//
// The band of a terrain's raster, and its overviews, which are sampled when they are asked for.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <gdal_priv.h>

#include "engine/query/questions.h"

namespace ptin::tools {

class TerrainDataset;

/// Pixels are the TIN at their centres; nothing is averaged. GDAL's `eResampleAlg` is not looked at: a
/// window that is asked for in another number of pixels is sampled at the centres of these.
class TerrainBand final : public GDALRasterBand {
 public:
  /// The band of the full raster, with its overviews.
  explicit TerrainBand(TerrainDataset& dataset);

  CPLErr IReadBlock(int column, int row, void* data) override;
  CPLErr IRasterIO(GDALRWFlag mode, int column, int row, int width, int height, void* data,
                   int columns, int rows, GDALDataType type, GSpacing pixel_space,
                   GSpacing line_space, GDALRasterIOExtraArg* extra) override;
  double GetNoDataValue(int* is_there) override;
  double GetMinimum(int* is_there) override;
  double GetMaximum(int* is_there) override;
  /// Least and largest height of the samples, from the header: those of all pixels lie between them.
  CPLErr ComputeRasterMinMax(int is_approximate, double* min_max) override;
  /// The same, with mean and deviation as GDAL computes them from pixels.
  CPLErr ComputeStatistics(int is_approximate, double* min, double* max, double* mean,
                           double* deviation, GDALProgressFunc progress, void* data) override;
  const char* GetUnitType() override { return unit_.c_str(); }
  /// As elevation models have it: gdalbuildvrt joins what is of one kind.
  GDALColorInterp GetColorInterpretation() override { return GCI_GrayIndex; }
  int HasArbitraryOverviews() override { return TRUE; }
  /// GDAL asks for sizes, too: gdalwarp chooses among overviews.
  int GetOverviewCount() override { return static_cast<int>(overviews_.size()); }
  GDALRasterBand* GetOverview(int i) override;

 private:
  /// A part of the band, in its pixels, at any places.
  struct Part {
    double column, row, width, height;
  };
  /// Where sampled pixels go: `columns` x `rows` of them.
  struct Target {
    void* data;
    int columns, rows;
    GDALDataType type;
    GSpacing pixel_space, line_space;
  };
  TerrainBand(TerrainDataset& dataset, int shift);
  void tell_certified();
  [[nodiscard]] bool has_range() const noexcept;
  [[nodiscard]] RasterRequest request_for(const Part& part, int columns, int rows) const;
  void sample(const Part& part, const Target& target, const GDALRasterIOExtraArg* extra) const;
  void store(const RasterBlock& block, const RasterRequest& request, const Target& target) const;

  TerrainDataset& dataset_;
  double nodata_;
  std::string unit_;
  std::function<MapPoint(MapPoint)> per_map_unit_;
  std::vector<std::unique_ptr<TerrainBand>> overviews_;
};

}  // namespace ptin::tools
