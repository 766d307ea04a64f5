// SPDX-License-Identifier: GPL-3.0-or-later
//
// Real rasters come back from their terrains.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/share_of_cases.h"
#include "tests/tools/program.h"
#include "tests/tools/whole_raster.h"

namespace ptin::tools {
namespace {

using testing::expect_done;

class RealRaster : public ::testing::TestWithParam<const char*> {};

TEST_P(RealRaster, ComesBackBitForBit) {
  const std::string source = (std::filesystem::path(PTIN_SHARED_DATA) / GetParam()).string();
  if (!std::filesystem::exists(source)) GTEST_SKIP() << "needs " << source;
  const testing::TestFolder folder;
  expect_done({"build", source, "-o", folder.file("s.ptin"), "-q"});
  expect_done({"export", folder.file("s.ptin"), "--source", "-o", folder.file("s.tif"), "-q"});
  testing::expect_same_raster(folder.file("s.tif"), source);
}

std::vector<const char*> real_rasters() {
  std::vector<const char*> names = {"dtm5m_austria_alr_float64.tif", "ned13_portland_nodata.tif",
                                    "srtm1_bigtujunga_utm_1197x643.tif"};
  if (test::wants_all_cases()) {
    names.insert(names.end(), {"srtm3_rainier_1201.tif", "lidar_dtm1m_slovenia_564_146.tif",
                               "srtm3_n53e027_minsk_uint16.tif", "srtm1_n48w125_olympic_3601.tif",
                               "mosaic_thames/thames.vrt", "mosaic_northengland/northengland.vrt"});
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, RealRaster, ::testing::ValuesIn(real_rasters()));

}  // namespace
}  // namespace ptin::tools
