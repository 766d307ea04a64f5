// SPDX-License-Identifier: GPL-3.0-or-later
//
// Builds that begin with a first pass, held to their promises and against those that do not.
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/mesh/validate.h"
#include "engine/query/questions.h"
#include "tests/construct/collapse/first_pass_rasters.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/surface_oracle.h"

namespace ptin {
namespace {

using oracle::RasterSpec;
using oracle::TestTerrain;

oracle::RasterFile file_to_thin(const RasterSpec& spec) {
  oracle::RasterFile file;
  file.columns = spec.width;
  file.rows = spec.height;
  file.step = 1.0;
  file.nodata = -9999;
  file.type = spec.heights.type == HeightType::int32 ? GDT_Int32 : GDT_Float32;
  file.value = [spec](int column, int row) {
    const int y = spec.height - 1 - row;
    return spec.valid && !spec.valid(column, y) ? -9999.0 : spec.code(column, y);
  };
  return file;
}

/// Builds with --max-error, tiles of this side, and holds levels against those of all samples.
void check_thinned_build(const RasterSpec& spec, std::int64_t side) {
  SCOPED_TRACE(spec.name + ", tiles of " + std::to_string(side));
  const TestTerrain terrain = oracle::make_raster(spec);
  const oracle::WrittenRaster raster(file_to_thin(spec));
  const oracle::ScratchFolder folder;
  BuildOptions options;
  options.tile = side;
  const BuildReport whole = build({raster.path()}, folder.file("whole.ptin"), options, {});
  options.max_error = 4.0;
  const BuildReport some = build({raster.path()}, folder.file("some.ptin"), options, {});
  const Terrain tin = Terrain::open(folder.file("some.ptin"));
  const Terrain all = Terrain::open(folder.file("whole.ptin"));
  EXPECT_EQ(tin.store().facts().base_error > 0.0, spec.name != "all void");
  EXPECT_LE(tin.store().facts().base_error, 4.0);
  for (const double tolerance : {4.0, 9.0, 30.0}) {
    RefineRequest request;
    request.detail.tolerance = tolerance;
    const RefinedTin refined = tin.refine(request);
    EXPECT_EQ(validate(refined.tin), "");
    EXPECT_EQ(oracle::check_samples(terrain, refined.tin, tolerance), "");
    EXPECT_EQ(oracle::check_deviation(terrain, refined.tin, refined.certified_deviation), "");
    EXPECT_LE(refined.tin.vertices.size(), all.refine(request).tin.vertices.size() * 6 / 5 + 20);
  }
  EXPECT_LT(some.records, whole.records);
}

/// Leaves thin their common sides where squares of right triangles fit them, 64 samples and more;
/// else they keep all samples of sides, and squares leave a rest in each leaf: 48.
TEST(FirstPass, ABuildKeepsItsPromisesAndNeedsHardlyMoreVertices) {
  for (RasterSpec spec : test::specs()) {
    spec.origin = {};
    check_thinned_build(spec, 48);
    if (spec.width > 100) {
      spec.width = 171;
      spec.height = 149;
      check_thinned_build(spec, 64);
    }
  }
}

}  // namespace
}  // namespace ptin
