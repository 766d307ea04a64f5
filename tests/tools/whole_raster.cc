// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/whole_raster.h"

#include <cstring>
#include <stdexcept>

#include <gdal_priv.h>
#include <gtest/gtest.h>

namespace ptin::tools::testing {

Whole read_whole(const std::string& path) {
  GDALAllRegister();
  const GDALDatasetUniquePtr data(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER));
  if (!data) throw std::runtime_error("cannot open " + path);
  GDALRasterBand& band = *data->GetRasterBand(1);
  Whole r;
  const auto item = [](const char* text) { return std::string(text == nullptr ? "" : text); };
  r.width = data->GetRasterXSize(), r.height = data->GetRasterYSize();
  r.type = GDALGetDataTypeName(band.GetRasterDataType());
  r.pixel_type = item(band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE"));
  r.pixels = item(data->GetMetadataItem(GDALMD_AREA_OR_POINT));
  r.is_placed = data->GetGeoTransform(r.place.data()) == CE_None;
  r.nodata = band.GetNoDataValue(&r.has_nodata);
  r.scale = band.GetScale(), r.offset = band.GetOffset();
  const int size = GDALGetDataTypeSizeBytes(band.GetRasterDataType());
  r.samples.resize(static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height) *
                   static_cast<std::size_t>(size));
  EXPECT_EQ(band.RasterIO(GF_Read, 0, 0, r.width, r.height, r.samples.data(), r.width, r.height,
                          band.GetRasterDataType(), 0, 0, nullptr),
            CE_None);
  if (const OGRSpatialReference* const crs = data->GetSpatialRef()) r.crs = *crs;
  return r;
}

void expect_same_raster(const std::string& made, const std::string& source) {
  const Whole a = read_whole(made), b = read_whole(source);
  EXPECT_EQ(a.width, b.width) << source;
  EXPECT_EQ(a.height, b.height) << source;
  EXPECT_EQ(a.type, b.type) << source;
  EXPECT_EQ(a.pixel_type, b.pixel_type) << source;
  EXPECT_EQ(a.has_nodata, b.has_nodata) << source;
  EXPECT_EQ(std::memcmp(&a.nodata, &b.nodata, sizeof a.nodata), 0) << a.nodata << " " << b.nodata;
  EXPECT_EQ(a.is_placed, b.is_placed) << source;
  EXPECT_EQ(a.place, b.place) << source;
  // GDAL takes what says nothing for areas.
  EXPECT_EQ(a.pixels == GDALMD_AOP_POINT, b.pixels == GDALMD_AOP_POINT) << source;
  EXPECT_EQ(a.scale, b.scale) << source;
  EXPECT_EQ(a.offset, b.offset) << source;
  EXPECT_TRUE(a.samples == b.samples) << source;
  EXPECT_EQ(a.crs.IsEmpty(), b.crs.IsEmpty()) << source;
  EXPECT_TRUE(b.crs.IsEmpty() != 0 || a.crs.IsSame(&b.crs) != 0) << source;
}

}  // namespace ptin::tools::testing
