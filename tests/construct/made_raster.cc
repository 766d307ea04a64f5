// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/made_raster.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

namespace ptin::oracle {

WrittenRaster::WrittenRaster(const RasterFile& raster) {
  static std::atomic<int> number{0};
  path_ = "/vsimem/written_" + std::to_string(number++) + ".tif";
  GDALAllRegister();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  GDALDatasetUniquePtr data(
      driver->Create(path_.c_str(), raster.columns, raster.rows, 1, raster.type, nullptr));
  std::array<double, 6> geotransform{500000, raster.step, 0, 4000000, 0, -raster.step};
  data->SetGeoTransform(geotransform.data());
  OGRSpatialReference srs;
  srs.SetFromUserInput(raster.srs.c_str());
  data->SetSpatialRef(&srs);
  GDALRasterBand* band = data->GetRasterBand(1);
  if (raster.nodata) {
    band->SetNoDataValue(*raster.nodata);
  }
  if (raster.scale != 1.0 || raster.offset != 0.0) {
    band->SetScale(raster.scale);
    band->SetOffset(raster.offset);
  }
  std::vector<double> values;
  for (int y = 0; y < raster.rows; ++y) {
    for (int x = 0; x < raster.columns; ++x) {
      values.push_back(raster.value(x, y));
    }
  }
  if (band->RasterIO(GF_Write, 0, 0, raster.columns, raster.rows, values.data(), raster.columns,
                     raster.rows, GDT_Float64, 0, 0, nullptr) != CE_None) {
    throw std::runtime_error("cannot write " + path_);
  }
}

WrittenRaster::~WrittenRaster() { VSIUnlink(path_.c_str()); }

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace ptin::oracle
