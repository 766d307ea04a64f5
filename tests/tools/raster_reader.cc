// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/raster_reader.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

namespace ptin::tools::testing {

ReadRaster read_raster(const std::string& path) {
  GDALAllRegister();
  ReadRaster raster;
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_RASTER);
  EXPECT_NE(dataset, nullptr);
  if (dataset == nullptr) return raster;
  raster.width = dataset->GetRasterXSize();
  raster.height = dataset->GetRasterYSize();
  raster.nodata = dataset->GetRasterBand(1)->GetNoDataValue();
  EXPECT_EQ(dataset->GetGeoTransform(raster.transform.data()), CE_None);
  raster.values.resize(static_cast<std::size_t>(raster.width) * raster.height);
  EXPECT_EQ(dataset->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, raster.width, raster.height,
                                                raster.values.data(), raster.width, raster.height,
                                                GDT_Float64, 0, 0),
            CE_None);
  GDALClose(dataset);
  return raster;
}

}  // namespace ptin::tools::testing
