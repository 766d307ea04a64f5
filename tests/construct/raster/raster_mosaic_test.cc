// SPDX-License-Identifier: GPL-3.0-or-later
//
// RasterSource: windows, several rasters of one grid, real terrains.
#include <cmath>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include <sys/resource.h>

#include "tests/construct/made_raster.h"
#include "tests/construct/raster/raster_fixture.h"
#include "tests/construct/task_runs.h"

namespace ptin {
namespace {

using namespace raster_fixture;

TEST(RasterSource, ReadsAnyWindowAsPartOfTheWhole) {
  Made made;
  made.columns = 70;
  made.rows = 50;
  for (int i = 0; i < made.columns * made.rows; ++i) {
    made.values.push_back(i % 997);
  }
  made.nodata = 13;
  made.creation = {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=32"};
  const RasterSource source = open(made);
  const Heights whole = heights_of(source);
  for (std::int64_t x : {0, 1, 15, 16, 60}) {
    for (std::int64_t y : {0, 17, 31, 40}) {
      const std::int64_t w = 10, h = 10;
      std::vector<HeightBits> bits(100);
      std::vector<std::uint8_t> valid(100);
      source.read({x, y, w, h}, bits, valid);
      for (std::int64_t i = 0; i < 100; ++i) {
        const double expected = whole[static_cast<std::size_t>((y + i / w) * 70 + x + i % w)];
        ASSERT_EQ(valid[i] == 0, std::isnan(expected));
        if (valid[i]) {
          ASSERT_EQ(source.frame().heights.height(bits[i]), expected);
        }
      }
    }
  }
}

TEST(RasterSource, RefusesAWindowOutsideOfTheTerrain) {
  const RasterSource source = open(small());
  std::vector<HeightBits> bits(4);
  std::vector<std::uint8_t> valid(4);
  EXPECT_THROW(source.read({2, 0, 2, 2}, bits, valid), Error);
  EXPECT_THROW(source.read({-1, 0, 2, 2}, bits, valid), Error);
  EXPECT_THROW(source.read({0, 0, 1, 2}, bits, valid), Error);
}

TEST(RasterSource, JoinsSeveralRastersOfOneGrid) {
  Made west = small(), east = small();
  west.name = "/vsimem/west.tif";
  east.name = "/vsimem/east.tif";
  east.geotransform = {120, 10, 0, 240, 0, -10};  // shares a column, one row further north
  east.values = {10, 20, 30, 40, -1, 60};
  east.nodata = -1;
  const RasterSource source = RasterSource::open({write(west), write(east)}, {});
  EXPECT_EQ(source.frame().map, (AffineMap{105, 215, 10, 10}));
  EXPECT_EQ(source.width(), 5);
  EXPECT_EQ(source.height(), 3);
  expect_heights(source, {4, 5, 6, kVoid, kVoid,  //
                          1, 2, 40, kVoid, 60,    //
                          kVoid, kVoid, 10, 20, 30});
  EXPECT_EQ(source.void_samples(), 5U);
  const RasterSource turned = RasterSource::open({east.name, west.name}, {});
  EXPECT_EQ(heights_of(turned)[7], 3) << "the last one with a height wins";
}

TEST(RasterSource, JoinsMoreFilesThanItKeepsOpen) {
  std::vector<std::string> paths;
  Heights expected;
  for (int i = 0; i < 100; ++i) {
    Made made = small();
    made.name = "/vsimem/column_" + std::to_string(i) + ".tif";
    made.columns = 1;
    made.rows = 2;
    made.values = {double(i), double(1000 + i)};
    made.geotransform = {100.0 + 10 * i, 10, 0, 230, 0, -10};
    paths.push_back(write(made));
    expected.push_back(1000 + i);
  }
  for (int i = 0; i < 100; ++i) {
    expected.push_back(i);
  }
  const RasterSource source = RasterSource::open(paths, {});
  expect_heights(source, expected);
  expect_heights(source, expected);
  expect_heights(source.duplicate(), expected);
}

/// As many descriptors as this, for as long as it lives.
class FewDescriptors {
 public:
  explicit FewDescriptors(rlim_t count) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = count;
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~FewDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

TEST(RasterSource, SharesTheDescriptorsOfTheProcessWithItsDuplicates) {
  constexpr int kFiles = 40;
  const oracle::ScratchFolder folder;
  std::vector<std::string> paths;
  Heights expected;
  for (int i = 0; i < kFiles; ++i) {
    Made made = small();
    made.name = folder.file(std::to_string(i) + ".tif");
    made.columns = made.rows = 2;
    made.values = {double(i), double(i), double(i), double(i)};
    made.geotransform = {100.0 + 20 * i, 10, 0, 230, 0, -10};
    paths.push_back(write(made));
  }
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i < 2 * kFiles; ++i) {
      expected.push_back(i / 2);
    }
  }
  const FewDescriptors limit(128);
  const RasterSource source = RasterSource::open(paths, {});
  std::vector<RasterSource> copies;
  for (int i = 0; i < 16; ++i) {
    copies.push_back(source.duplicate());
  }
  for (const RasterSource& copy : copies) {
    expect_heights(copy, expected);
  }
}

TEST(RasterSource, RefusesToJoinRastersOfDifferentGrids) {
  Made first = small(), second = small();
  first.name = "/vsimem/first.tif";
  second.name = "/vsimem/second.tif";
  write(first);
  const auto refused = [&](const std::string& word) {
    const Error e = open_error({first.name, write(second)});
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(e.context(), second.name);
    EXPECT_NE(e.message().find(word), std::string::npos) << e.what();
  };
  second.geotransform = {103, 10, 0, 230, 0, -10};
  refused("between those of the first");
  second.geotransform = {100, 10.1, 0, 230, 0, -10};
  refused("pixel size");
  second = small();
  second.name = "/vsimem/second.tif";
  second.type = GDT_Float32;
  refused("type");
  second.type = GDT_Int16;
  second.srs = "EPSG:32612";
  refused("CRS");
  second.geotransform.reset();
  refused("geotransform");
}

TEST(RasterSource, DuplicatesReadTheSame) {
  const RasterSource source = open(small());
  const RasterSource copy = source.duplicate();
  EXPECT_EQ(copy.valid_samples(), 6U);
  expect_heights(copy, heights_of(source));
}

TEST(RasterSource, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const std::string path = write(small());
  const Error e = open_error({path}, stop.get_token());
  EXPECT_EQ(e.code(), ErrorCode::cancelled);
}

TEST(RasterSource, ReportsItsProgressToTheEnd) {
  std::uint64_t last = 0, all = 0;
  const auto progress = [&](const StageProgress& told) {
    EXPECT_GT(told.done, last);
    last = told.done;
    all = told.total;
  };
  std::ignore = RasterSource::open({write(small())}, {}, test::on_threads(1, 0, {}, progress));
  EXPECT_EQ(last, 6U);
  EXPECT_EQ(all, 6U);
}

std::string test_data(const std::string& name) {
  return (std::filesystem::path(PTIN_TEST_DATA) / name).string();
}

TEST(RasterSourceOnRealTerrain, ReadsTheTerrainsOfThisFolder) {
  const RasterSource mountains = RasterSource::open({test_data("mountains_257.tif")}, {});
  EXPECT_EQ(mountains.valid_samples(), 257U * 257U);
  EXPECT_EQ(mountains.frame().min_height, 633);
  EXPECT_EQ(mountains.frame().max_height, 1576);
  EXPECT_EQ(mountains.frame().map.step_x, 30);
  const RasterSource coast = RasterSource::open({test_data("coast_257.tif")}, {});
  EXPECT_EQ(coast.valid_samples(), 42642U);
  EXPECT_EQ(coast.void_samples(), 257U * 257U - 42642U);
  EXPECT_TRUE(coast.frame().geographic);
}

std::string shared_data(const std::string& name) {
  return (std::filesystem::path(PTIN_SHARED_DATA) / name).string();
}

#define PTIN_SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here"

TEST(RasterSourceOnRealTerrain, ReadsAMosaicAsItsVrtAndAsItsFiles) {
  const std::string folder = shared_data("mosaic_northengland/");
  PTIN_SKIP_WITHOUT(folder);
  const RasterSource vrt = RasterSource::open({folder + "northengland.vrt"}, {});
  EXPECT_EQ(vrt.width(), 3601);
  EXPECT_EQ(vrt.height(), 2401);
  EXPECT_EQ(vrt.frame().min_height, -49);
  EXPECT_EQ(vrt.frame().max_height, 1059);
  EXPECT_TRUE(vrt.frame().geographic);
  EXPECT_EQ(vrt.frame().horizontal_unit, "degree");
  std::vector<std::string> files;
  for (const char* tile : {"n53w004", "n53w003", "n53w002", "n54w004", "n54w003", "n54w002"}) {
    files.push_back(folder + "srtm3_" + tile + ".tif");
  }
  const RasterSource joined = RasterSource::open(files, {});
  EXPECT_NEAR(joined.frame().map.origin_x, vrt.frame().map.origin_x, 1e-9);
  EXPECT_NEAR(joined.frame().map.origin_y, vrt.frame().map.origin_y, 1e-9);
  EXPECT_EQ(joined.valid_samples(), vrt.valid_samples());
  EXPECT_TRUE(heights_of(joined) == heights_of(vrt));
}

TEST(RasterSourceOnRealTerrain, KnowsWhatEachDeclares) {
  struct Expected {
    const char* name;
    std::uint64_t valid;
    double low, high;
    HeightType type;
    double quantum;
  };
  for (const Expected& e : {
           Expected{"srtm1_n48w125_olympic_3601.tif", 6483325, -13, 1095, HeightType::int32, 1},
           Expected{"srtm3_rainier_1201.tif", 1433368, 263, 4371, HeightType::int32, 1},
           Expected{"srtm3_n53e027_minsk_uint16.tif", 1442401, 142, 354, HeightType::int32, 1},
           Expected{"lidar_dtm1m_slovenia_564_146.tif", 1000000, 254.97, 325.05,
                    HeightType::float32, 0.01},
       }) {
    const std::string path = shared_data(e.name);
    PTIN_SKIP_WITHOUT(path);
    const RasterSource source = RasterSource::open({path}, {});
    EXPECT_EQ(source.valid_samples(), e.valid) << e.name;
    EXPECT_NEAR(source.frame().min_height, e.low, 1e-4) << e.name;
    EXPECT_NEAR(source.frame().max_height, e.high, 1e-4) << e.name;
    EXPECT_EQ(source.frame().heights.type, e.type) << e.name;
    EXPECT_EQ(source.frame().height_quantum, e.quantum) << e.name;
  }
}

TEST(RasterSourceOnRealTerrain, KeepsFloat64ThatWasFloat32) {
  const std::string path = shared_data("dtm5m_austria_alr_float64.tif");
  PTIN_SKIP_WITHOUT(path);
  const RasterSource source = RasterSource::open({path}, {});
  EXPECT_EQ(source.frame().heights.type, HeightType::float32);
  EXPECT_EQ(source.frame().height_rounding, 0);
  EXPECT_NEAR(static_cast<double>(source.valid_samples()) / (417 * 915), 0.694, 0.001);
}

}  // namespace
}  // namespace ptin
