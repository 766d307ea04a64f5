// SPDX-License-Identifier: GPL-3.0-or-later
//
// The output that a build plans for, of sources that nothing makes smaller.
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/construct/build.h"
#include "engine/construct/build_plan.h"
#include "tests/construct/made_raster.h"
#include "tests/construct/told_build.h"

namespace ptin {
namespace {

using oracle::RasterFile;
using oracle::ScratchFolder;
using oracle::WrittenRaster;

/// Builds `input`, which is noise: the output fits into what was planned for it, and nearly needs it.
void expect_planned_output(const std::string& input) {
  const ScratchFolder folder;
  std::uint64_t planned = 0;
  oracle::ToldBuild told;
  told.on_plan = [&](const BuildPlan& plan) { planned = plan.output_bytes; };
  BuildResources resources;
  resources.observer = &told;
  build({input}, folder.file("out.ptin"), {}, resources);
  const std::uint64_t taken = std::filesystem::file_size(folder.file("out.ptin"));
  EXPECT_LE(taken, planned);
  EXPECT_GE(taken, (planned - (std::uint64_t{1} << 20)) * 85 / 100);  // a MiB is for small files
}

TEST(Build, PlansForTheOutputOfNoise) {
  std::mt19937_64 random(1);
  RasterFile file;
  file.columns = 400;
  file.rows = 300;
  // Numbers that are rounded have no tiles of heights, so that pages have them.
  file.type = GDT_Float64;
  file.value = [&](int, int) { return static_cast<double>(random() >> 11) * 1e-7; };
  const WrittenRaster raster(file);
  expect_planned_output(raster.path());

  const ScratchFolder folder;
  std::string points = "x,y,z\n";
  const auto number = [&] {
    return std::to_string(random() % 1000) + '.' +
           std::to_string(1000000 + random() % 1000000).substr(1);
  };
  for (int i = 0; i < 50000; ++i) {
    points += number() + ',' + number() + ',' + number() + '\n';
  }
  oracle::write_text(folder.file("points.csv"), points);
  expect_planned_output(folder.file("points.csv"));
}

}  // namespace
}  // namespace ptin
