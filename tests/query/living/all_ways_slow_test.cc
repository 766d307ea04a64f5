// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights, stars and splits of the real rasters that may be shared between clones, and what heights of those of the tree cost.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "storage/floor.h"
#include "tests/query/built_terrain.h"
#include "tests/query/living/all_ways.h"
#include "tests/support/share_of_cases.h"
#include "tests/support/test_folder.h"

namespace ptin {
namespace {

TEST(Heights, AreReadInFewPagesNodesAndRounds) {
  for (const char* name : {"mountains_257.tif", "coast_257.tif"}) {
    SCOPED_TRACE(name);
    reference::expect_few_reads(reference::built_terrain(name), 2);
    reference::expect_few_rounds(reference::built_terrain(name), 3);
  }
}

TEST(AllWaysOfSharedRasters, AnswerTheSame) {
  const std::string shared = PTIN_SHARED_DATA;
  // The one by default has voids, and no step.
  std::vector<std::string> names = {"dtm5m_austria_alr_float64.tif"};
  if (test::wants_all_cases()) {
    names.insert(names.end(),
                 {"srtm1_bigtujunga_utm_1197x643.tif", "lidar_dtm1m_slovenia_564_146.tif",
                  "srtm3_rainier_1201.tif", "srtm3_n53e027_minsk_uint16.tif",
                  "ned13_portland_nodata.tif", "mosaic_thames/thames.vrt",
                  "mosaic_northengland/northengland.vrt", "srtm1_n48w125_olympic_3601.tif"});
  }
  std::size_t asked = 0;
  for (const std::string& name : names) {
    if (!std::filesystem::exists(shared + "/" + name)) continue;
    SCOPED_TRACE(name);
    const test::TestFolder folder;
    build({shared + "/" + name}, folder.file("a.ptin"), {}, {});
    const Terrain terrain = Terrain::open(folder.file("a.ptin"));
    ASSERT_NE(terrain.floor(), nullptr);
    reference::expect_same_by_all_ways(terrain,
                                       {.points = 10000,
                                        .splits = 100,
                                        .lines = 4,
                                        .windows = 2,
                                        .window_share = 0.1,
                                        .asks_whole = false},
                                       7);
    reference::expect_few_reads(terrain, 8);
    reference::expect_few_rounds(terrain, 9);
    ++asked;
  }
  if (asked == 0) GTEST_SKIP() << "needs " << shared << ", a folder with real rasters";
}

}  // namespace
}  // namespace ptin
