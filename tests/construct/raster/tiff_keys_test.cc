// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/tiff_keys.h"

#include <fstream>
#include <iterator>
#include <string>

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include "tests/support/test_folder.h"

namespace ptin {
namespace {

/// A TIFF that GDAL writes, of a CRS that needs all three tags: numbers, doubles and names.
void write_tiff(const std::string& path, const char* endianness, const char* is_big) {
  GDALAllRegister();
  OGRSpatialReference crs;
  ASSERT_EQ(crs.SetFromUserInput("+proj=tmerc +lat_0=45.5 +lon_0=10.25 +k=0.9996 +x_0=500000 "
                                 "+y_0=0 +ellps=GRS80 +units=m +vunits=us-ft +geoidgrids=@none"),
            OGRERR_NONE);
  const char* const options[] = {endianness, is_big, nullptr};
  const GDALDatasetUniquePtr file(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      path.c_str(), 2, 2, 1, GDT_Float32, const_cast<char**>(options)));
  ASSERT_NE(file, nullptr);
  double place[] = {500000, 30, 0, 4000000, 0, -30};
  file->SetGeoTransform(place);
  file->SetSpatialRef(&crs);
}

TEST(TiffKeys, AreTheSameInEitherByteOrder) {
  const test::TestFolder folder(test::TestFolder::Size::kSmall);
  for (const char* is_big : {"BIGTIFF=NO", "BIGTIFF=YES"}) {
    write_tiff(folder.file("little.tif"), "ENDIANNESS=LITTLE", is_big);
    write_tiff(folder.file("big.tif"), "ENDIANNESS=BIG", is_big);
    const GeoTiffKeys little = keys_of_tiff(folder.file("little.tif"));
    const GeoTiffKeys big = keys_of_tiff(folder.file("big.tif"));
    ASSERT_FALSE(little.directory.empty());
    ASSERT_FALSE(little.doubles.empty());
    ASSERT_FALSE(little.text.empty());
    EXPECT_EQ(little.directory, big.directory) << is_big;
    EXPECT_EQ(little.doubles, big.doubles) << is_big;
    EXPECT_EQ(little.text, big.text) << is_big;
    EXPECT_EQ(tell_of_heights(little), tell_of_heights(big));
  }
}

TEST(TiffKeys, OfAFileThatIsCutOffAreThoseOfTheWholeOrNone) {
  const test::TestFolder folder(test::TestFolder::Size::kSmall);
  write_tiff(folder.file("whole.tif"), "ENDIANNESS=BIG", "BIGTIFF=NO");
  std::ifstream in(folder.file("whole.tif"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const GeoTiffKeys whole = keys_of_tiff(folder.file("whole.tif"));
  for (std::size_t length = 0; length < bytes.size(); length += 7) {
    std::ofstream(folder.file("cut.tif"), std::ios::binary) << bytes.substr(0, length);
    const GeoTiffKeys keys = keys_of_tiff(folder.file("cut.tif"));
    EXPECT_TRUE(keys.directory.empty() || keys.directory == whole.directory) << length;
    EXPECT_TRUE(keys.doubles.empty() || keys.doubles == whole.doubles) << length;
    EXPECT_TRUE(keys.text.empty() || keys.text == whole.text) << length;
  }
}

}  // namespace
}  // namespace ptin
