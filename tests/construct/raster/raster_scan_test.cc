// SPDX-License-Identifier: GPL-3.0-or-later
//
// The first reading of a raster, in bands.
#include "engine/construct/raster/raster_scan.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/construct/raster/raster_fixture.h"
#include "tests/construct/task_runs.h"

namespace ptin {
namespace {

using namespace raster_fixture;

/// Heights from -40 to 60 in steps of 1/16, and voids.
Made wavy(GDALDataType type, double step) {
  Made made;
  made.columns = 70;
  made.rows = 50;
  made.type = type;
  made.nodata = -9999;
  for (int i = 0; i < made.columns * made.rows; ++i) {
    const double height = std::round((10 + 50 * std::sin(0.01 * i)) / step) * step;
    made.values.push_back(i % 31 == 7 ? -9999 : height);
  }
  return made;
}

/// What bands of so many samples find, done in a shuffled order and each twice.
HeightFit fit_in_bands(const Made& made, std::int64_t samples, std::size_t least_bands) {
  RasterScan scan(RasterMosaic({write(made)}, {}), samples);
  TaskList list = scan.tasks();
  std::vector<Task> tasks = test::taken_from(list);
  EXPECT_GE(tasks.size(), least_bands);
  const std::vector<Task> again = tasks;
  tasks.insert(tasks.end(), again.begin(), again.end());
  std::mt19937 random(7);
  std::shuffle(tasks.begin(), tasks.end(), random);
  for (const Task& task : tasks) {
    list.done(task.name, scan.run(task));
  }
  return scan.join(list.results()).fit;
}

void expect_same(const HeightFit& a, const HeightFit& b) {
  EXPECT_EQ(a.encoding.type, b.encoding.type);
  EXPECT_EQ(a.encoding.step, b.encoding.step);
  EXPECT_EQ(a.encoding.offset, b.encoding.offset);
  EXPECT_EQ(a.quantum, b.quantum);
  EXPECT_EQ(a.rounding, b.rounding);
  EXPECT_EQ(a.min_height, b.min_height);
  EXPECT_EQ(a.max_height, b.max_height);
  EXPECT_EQ(a.count, b.count);
}

TEST(RasterScan, FindsInBandsWhatItFindsInOne) {
  Made whole = wavy(GDT_Int16, 1), tiled = wavy(GDT_Float32, 0.0625), codes = wavy(GDT_Int16, 1);
  tiled.creation = {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"};
  codes.scale = 0.01;
  codes.offset = 3;
  for (const Made& made : {whole, tiled, codes, wavy(GDT_Float64, 0.01), wavy(GDT_Float64, 1),
                           wavy(GDT_Float64, 1e-7)}) {
    const HeightFit one = fit_in_bands(made, 1000000, 1);
    EXPECT_EQ(one.count,
              static_cast<std::uint64_t>(std::count_if(made.values.begin(), made.values.end(),
                                                       [](double v) { return v != -9999; })));
    expect_same(fit_in_bands(made, 1200, 3), one);
    expect_same(fit_in_bands(made, 1, 4), one);  // rows, or rows of blocks
  }
}

TEST(RasterScan, FindsThatNothingHasAHeight) {
  Made made = wavy(GDT_Float32, 1);
  std::fill(made.values.begin(), made.values.end(), -9999);
  const HeightFit fit = fit_in_bands(made, 1200, 3);
  EXPECT_EQ(fit.count, 0U);
  EXPECT_GT(fit.min_height, fit.max_height);
}

TEST(RasterScan, NamesTheFirstOfSeveralHeightsThatAreInfinite) {
  Made made = wavy(GDT_Float32, 1);
  made.values[70 * 45 + 3] = made.values[70 * 8 + 5] = INFINITY;
  RasterScan scan(RasterMosaic({write(made)}, {}), 70);
  for (const int threads : {1, 3}) {
    TaskList tasks = scan.tasks();
    const Error e = error_of([&] { test::on_threads(threads)(tasks, scan); });
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    EXPECT_NE(e.message().find("column 5, row 8 "), std::string::npos) << e.message();
  }
}

TEST(RasterScan, RefusesWhatAnotherProgramTells) {
  const RasterScan scan(RasterMosaic({write(small())}, {}));
  TaskResult result;
  result.told = "00ff";
  EXPECT_EQ(error_of([&] {
              std::ignore = scan.join({{numbered(TaskKind::kScan, 0), result}});
            }).code(),
            ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace ptin
