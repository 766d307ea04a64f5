// SPDX-License-Identifier: GPL-3.0-or-later
//
// From files to a store: what is refused, what is left behind, and what the store promises of its
// input.
#include "engine/construct/build.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/construct/build_plan.h"
#include "engine/error.h"
#include "engine/geometry/infinity.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "storage/verify.h"
#include "tests/construct/exact_oracle.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"
#include "tests/construct/told_build.h"

namespace ptin {
namespace {

using oracle::RasterFile;
using oracle::ScratchFolder;
using oracle::WrittenRaster;

double hills(int x, int y) { return 300.0 + 40.0 * std::sin(0.4 * x) * std::cos(0.3 * y) + x % 3; }

Error error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "no error was thrown";
  return Error(ErrorCode::internal, "none");
}

/// Every sample of `file` against the TIN of a query: within `bound`, with the heights as GDAL
/// would give them; `is_void` samples are not looked at.
void expect_within(const RasterFile& file, const Terrain& tin, const RefinedTin& refined,
                   double bound) {
  const HeightEncoding& heights = tin.store().facts().heights;
  ASSERT_EQ(validate(refined.tin), "");
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(file.columns * file.rows), 0);
  for (TriangleId t = 0; t < refined.tin.triangles.size(); ++t) {
    if (!oracle::is_surface(refined.tin, t)) {
      continue;
    }
    const oracle::Corners c = oracle::corners_of(refined.tin, t, heights);
    const GridBox box = oracle::box_of_corners(c);
    for (int y = box.min_y; y <= box.max_y; ++y) {
      for (int x = box.min_x; x <= box.max_x; ++x) {
        const int row = file.rows - 1 - y;
        const double given = file.value(x, row) * file.scale + file.offset;
        if (!oracle::in_closed(c, {x, y}) || (file.nodata && file.value(x, row) == *file.nodata)) {
          continue;
        }
        seen[static_cast<std::size_t>(y * file.columns + x)] = 1;
        long double height = 0, area = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto part = static_cast<long double>(
              oracle::side(c[(i + 1) % 3].position, c[(i + 2) % 3].position, {x, y}));
          height += part * static_cast<long double>(heights.height_of_code(c[i].code));
          area += part;
        }
        EXPECT_LE(std::abs(height / area - given), bound + 1e-12 * std::abs(given))
            << x << " " << y;
      }
    }
  }
  if (!file.nodata) {
    EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](std::uint8_t s) { return s != 0; }));
  }
}

/// Builds, verifies, and checks full detail and some tolerances.
void expect_built(const RasterFile& file, const BuildOptions& options = {}) {
  const WrittenRaster raster(file);
  const ScratchFolder folder;
  const std::string path = folder.file("out.ptin");
  const BuildReport report = build({raster.path()}, path, options, {});
  EXPECT_EQ(folder.names(), std::vector<std::string>{"out.ptin"});
  EXPECT_EQ(report.file_bytes, std::filesystem::file_size(path));
  const Terrain tin = Terrain::open(path);
  EXPECT_EQ(report.records, tin.store().record_count());
  EXPECT_EQ(report.t0_vertices, tin.store().t0().vertices.size());
  const double base = tin.store().facts().base_error;
  const RefinedTin full = tin.refine({});
  EXPECT_GE(full.certified_error, base);
  expect_within(file, tin, full, base);
  EXPECT_EQ(full.vertices, report.records + report.t0_vertices);
  for (const double tolerance : {0.0, 0.5, 3.0, 20.0}) {
    RefineRequest request;
    request.detail.tolerance = tolerance;
    const RefinedTin refined = tin.refine(request);
    EXPECT_LE(refined.certified_error, std::max(tolerance, base));
    expect_within(file, tin, refined, refined.certified_error);
  }
}

RasterFile plain(GDALDataType type) {
  RasterFile file;
  file.value = [](int x, int y) { return std::floor(hills(x, y)); };
  file.type = type;
  return file;
}

TEST(Build, KeepsItsPromisesForEveryTypeOfRaster) {
  for (const GDALDataType type :
       {GDT_Int16, GDT_UInt16, GDT_Int32, GDT_Float32, GDT_Float64, GDT_Byte}) {
    RasterFile file = plain(type);
    if (type == GDT_Byte) {
      file.value = [](int x, int y) { return std::floor(hills(x, y) / 2); };
    }
    expect_built(file);
  }
}

TEST(Build, KeepsItsPromisesForScaleAndOffset) {
  RasterFile file = plain(GDT_Int16);
  file.scale = 0.01;
  file.offset = -120.0;
  expect_built(file);
  file.scale = -0.5;
  expect_built(file);
}

TEST(Build, KeepsItsPromisesForFractions) {
  RasterFile file = plain(GDT_Float32);
  file.value = [](int x, int y) { return static_cast<double>(static_cast<float>(hills(x, y))); };
  expect_built(file);
}

TEST(Build, AddsTheRoundingOfHeightsThatNoEncodingHolds) {
  RasterFile file = plain(GDT_Float64);
  file.value = hills;
  expect_built(file);
  const WrittenRaster raster(file);
  const ScratchFolder folder;
  const BuildReport report = build({raster.path()}, folder.file("out.ptin"), {}, {});
  EXPECT_GT(report.height_rounding, 0.0);
  const Terrain tin = Terrain::open(folder.file("out.ptin"));
  EXPECT_EQ(tin.store().facts().base_error, report.height_rounding);
  EXPECT_FALSE(tin.refine({}).exact);
}

TEST(Build, KeepsItsPromisesForEveryCost) {
  for (const CostModel cost : {CostModel::kError, CostModel::kRoi, CostModel::kElevation}) {
    BuildOptions options;
    options.cost = cost;
    expect_built(plain(GDT_Int16), options);
  }
}

TEST(Build, LeavesOutWhatIsBelowTheLargestError) {
  for (const double max_error : {0.5, 2.0, 5.0, 1000.0}) {
    const RasterFile file = plain(GDT_Int16);
    const WrittenRaster raster(file);
    const ScratchFolder folder;
    BuildOptions options;
    options.max_error = max_error;
    const BuildReport report = build({raster.path()}, folder.file("some.ptin"), options, {});
    const BuildReport all = build({raster.path()}, folder.file("all.ptin"), {}, {});
    EXPECT_LT(report.records, all.records);
    const Terrain tin = Terrain::open(folder.file("some.ptin"));
    const double base = tin.store().facts().base_error;
    EXPECT_GT(base, 0.0);
    EXPECT_LE(base, max_error);
    EXPECT_GE(tin.store().facts().base_deviation, base);
    expect_within(file, tin, tin.refine({}), base);
    // The same as the whole store refined to that error.
    RefineRequest request;
    request.detail.tolerance = max_error;
    const Terrain whole = Terrain::open(folder.file("all.ptin"));
    EXPECT_TRUE(oracle::named_triangles(tin.refine({}).tin) ==
                oracle::named_triangles(whole.refine(request).tin));
  }
}

TEST(Build, AcceptsVoidsOfEveryKind) {
  const std::function<bool(int, int)> masks[] = {
      [](int, int) { return true; },
      [](int x, int y) { return x == 7 && y == 9; },
      [](int x, int y) { return x != 7 || y != 9; },
      [](int x, int y) { return (x + y) % 2 == 0; },
      [](int x, int y) { return x > 4 + y % 3; },
      [](int, int) { return false; },
  };
  for (const auto& is_void : masks) {
    RasterFile file = plain(GDT_Int16);
    file.nodata = -32768;
    file.value = [is_void](int x, int y) {
      return is_void(x, y) ? -32768 : std::floor(hills(x, y));
    };
    expect_built(file);
  }
}

TEST(Build, WritesTheSameBytesTwice) {
  const WrittenRaster raster(plain(GDT_Float32));
  const ScratchFolder folder;
  for (const double max_error : {0.0, 3.0}) {
    BuildOptions options;
    options.max_error = max_error;
    BuildResources resources;
    resources.overwrite = true;
    build({raster.path()}, folder.file("a.ptin"), options, resources);
    build({raster.path()}, folder.file("b.ptin"), options, resources);
    EXPECT_TRUE(oracle::bytes_of(folder.file("a.ptin")) == oracle::bytes_of(folder.file("b.ptin")));
  }
}

TEST(Build, WritesWholeStoresThatVerify) {
  const WrittenRaster raster(plain(GDT_Int32));
  const ScratchFolder folder;
  build({raster.path()}, folder.file("out.ptin"), {}, {});
  EXPECT_TRUE(verify_store(folder.file("out.ptin")).faults.empty());
}

TEST(Build, BuildsFromPoints) {
  const ScratchFolder folder;
  std::string text = "x,y,z\n";
  for (int i = 0; i < 300; ++i) {
    text += std::to_string(i * 37 % 101) + "." + std::to_string(i % 10) + "," +
            std::to_string(i * 53 % 97) + "," + std::to_string(i * i % 60) + ".25\n";
  }
  oracle::write_text(folder.file("points.csv"), text);
  const BuildReport report = build({folder.file("points.csv")}, folder.file("out.ptin"), {}, {});
  const Terrain tin = Terrain::open(folder.file("out.ptin"));
  const RefinedTin full = tin.refine({});
  EXPECT_EQ(full.vertices, report.source_samples);
  EXPECT_EQ(validate(full.tin), "");
  EXPECT_TRUE(full.exact);
}

struct BadInput {
  std::string text;
  ErrorCode code;
};

TEST(Build, RefusesBadInputAndLeavesNothingBehind) {
  const std::vector<std::pair<std::string, BadInput>> inputs = {
      {"two.csv", {"x,y,z\n1,1,1\n2,2,2\n", ErrorCode::invalid_argument}},
      {"line.csv", {"x,y,z\n1,1,1\n2,2,2\n3,3,5\n9,9,1\n", ErrorCode::invalid_argument}},
      {"same.csv", {"x,y,z\n1,1,1\n1,1,2\n1,1,5\n", ErrorCode::invalid_argument}},
      {"nan.csv", {"x,y,z\n1,1,1\n2,1,nan\n3,3,5\n", ErrorCode::invalid_argument}},
      {"infinite.csv", {"x,y,z\n1,1,1\n2,1,inf\n3,3,5\n", ErrorCode::invalid_argument}},
      {"wide.csv", {"x,y,z\n0.001,1,1\n3e9,1,2\n3,3,5\n", ErrorCode::invalid_argument}},
      {"empty.csv", {"", ErrorCode::invalid_argument}},
      {"words.tif", {"this is no raster", ErrorCode::invalid_argument}},
      {"words.unknown", {"neither is this", ErrorCode::invalid_argument}},
  };
  for (const auto& [name, bad] : inputs) {
    SCOPED_TRACE(name);
    const ScratchFolder folder;
    oracle::write_text(folder.file(name), bad.text);
    const Error e = error_of([&] { build({folder.file(name)}, folder.file("out.ptin"), {}, {}); });
    EXPECT_EQ(e.code(), bad.code) << e.what();
    EXPECT_EQ(folder.names(), std::vector<std::string>{name});
  }
}

TEST(Build, RefusesInputsThatDoNotExistOrDoNotFitTogether) {
  const ScratchFolder folder;
  const WrittenRaster raster(plain(GDT_Int16));
  oracle::write_text(folder.file("p.csv"), "x,y,z\n0,0,1\n1,0,1\n0,1,1\n");
  const std::string out = folder.file("out.ptin");
  EXPECT_EQ(error_of([&] { build({}, out, {}, {}); }).code(), ErrorCode::invalid_argument);
  EXPECT_EQ(error_of([&] { build({folder.file("none.tif")}, out, {}, {}); }).code(),
            ErrorCode::not_found);
  EXPECT_EQ(error_of([&] { build({folder.file("none.csv")}, out, {}, {}); }).code(),
            ErrorCode::not_found);
  EXPECT_EQ(error_of([&] {
              build({raster.path(), folder.file("p.csv")}, out, {}, {});
            }).code(),
            ErrorCode::invalid_argument);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"p.csv"});
}

TEST(Build, RefusesInfiniteHeightsAndOneRow) {
  const ScratchFolder folder;
  RasterFile infinite = plain(GDT_Float32);
  infinite.value = [](int x, int y) {
    return x == 3 && y == 3 ? std::numeric_limits<double>::infinity() : 1.0;
  };
  RasterFile row = plain(GDT_Int16);
  row.rows = 1;
  for (const RasterFile& file : {infinite, row}) {
    const WrittenRaster raster(file);
    EXPECT_EQ(error_of([&] { build({raster.path()}, folder.file("out.ptin"), {}, {}); }).code(),
              ErrorCode::invalid_argument);
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(Build, RefusesOptionsThatMeanNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const WrittenRaster raster(plain(GDT_Int16));
  const ScratchFolder folder;
  const auto refused = [&](const BuildOptions& options) {
    try {
      build({raster.path()}, folder.file("out.ptin"), options, {});
    } catch (const Error& e) {
      return e.code() == ErrorCode::invalid_argument;
    }
    return false;
  };
  for (const double bad : {kNan, -1.0, kInfinity}) {
    BuildOptions options;
    options.max_error = bad;
    EXPECT_TRUE(refused(options)) << "max_error " << bad;
    options = {};
    options.void_slope = bad;
    EXPECT_TRUE(refused(options)) << "void_slope " << bad;
  }
  BuildOptions options;
  options.page_bytes = 5000;
  EXPECT_TRUE(refused(options));
  EXPECT_TRUE(folder.names().empty());
}

TEST(Build, KeepsAnExistingFileUnlessToldOtherwise) {
  const WrittenRaster raster(plain(GDT_Int16));
  const ScratchFolder folder;
  oracle::write_text(folder.file("out.ptin"), "mine");
  EXPECT_EQ(error_of([&] { build({raster.path()}, folder.file("out.ptin"), {}, {}); }).code(),
            ErrorCode::invalid_argument);
  EXPECT_EQ(oracle::bytes_of(folder.file("out.ptin")), "mine");
  BuildResources resources;
  resources.overwrite = true;
  build({raster.path()}, folder.file("out.ptin"), {}, resources);
  EXPECT_EQ(Terrain::open(folder.file("out.ptin")).refine({}).vertices, 400U);
}

TEST(Build, SaysThatItMayNotWrite) {
  if (::geteuid() == 0) {
    GTEST_SKIP() << "needs a user whom permissions bind";
  }
  const WrittenRaster raster(plain(GDT_Int16));
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.file("closed"));
  std::filesystem::permissions(folder.file("closed"), std::filesystem::perms::owner_read);
  EXPECT_EQ(
      error_of([&] { build({raster.path()}, folder.file("closed/out.ptin"), {}, {}); }).code(),
      ErrorCode::io_error);
}

TEST(Build, SaysThatTheFolderIsMissing) {
  const WrittenRaster raster(plain(GDT_Int16));
  const ScratchFolder folder;
  EXPECT_EQ(error_of([&] { build({raster.path()}, folder.file("no/out.ptin"), {}, {}); }).code(),
            ErrorCode::not_found);
}

TEST(Build, IsCancelledAtEveryStageAndKeepsWhatIsDone) {
  RasterFile file = plain(GDT_Int16);
  file.columns = file.rows = 90;
  const WrittenRaster raster(file);
  for (const std::string stage : {"reading", "collapsing", "tightening"}) {
    SCOPED_TRACE(stage);
    const ScratchFolder folder;
    oracle::write_text(folder.file("out.ptin"), "mine");
    std::stop_source source;
    BuildResources resources;
    resources.overwrite = true;
    resources.stop = source.get_token();
    oracle::ToldBuild told;
    resources.observer = &told;
    told.on_stage = [&](const char* name, std::uint64_t, std::uint64_t) {
      if (name == stage) {
        source.request_stop();
      }
    };
    BuildOptions options;
    options.tile = 32;
    EXPECT_EQ(error_of([&] {
                build({raster.path()}, folder.file("out.ptin"), options, resources);
              }).code(),
              ErrorCode::cancelled);
    EXPECT_TRUE(oracle::bytes_of(folder.file("out.ptin")) == "mine");
    resources.stop = {};
    resources.unfinished = Unfinished::kResume;
    build({raster.path()}, folder.file("out.ptin"), options, resources);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"out.ptin"});
    build({raster.path()}, folder.file("plain.ptin"), options, {});
    EXPECT_TRUE(oracle::bytes_of(folder.file("out.ptin")) ==
                oracle::bytes_of(folder.file("plain.ptin")));
  }
}

}  // namespace
}  // namespace ptin
