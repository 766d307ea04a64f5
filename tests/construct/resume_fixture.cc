// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/resume_fixture.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

namespace ptin::test {

namespace {

oracle::RasterFile hills_with_a_lake() {
  oracle::RasterFile file;
  file.columns = file.rows = 65;
  file.value = [](int x, int y) {
    const double hill =
        300.0 + 40.0 * std::sin(0.2 * x) * std::cos(0.13 * y) + (x * 7 + y * 5) % 11;
    return std::fmax(hill, 290.0);
  };
  return file;
}

}  // namespace

InterruptibleBuild::InterruptibleBuild() : raster_(hills_with_a_lake()) {
  const std::string plain = folder_.file("plain.ptin");
  build({raster_.path()}, plain, options(), {});
  expected_ = oracle::bytes_of(plain);
  std::filesystem::remove(plain);
}

BuildOptions InterruptibleBuild::options() const {
  BuildOptions options;
  options.tile = 16;
  return options;
}

BuildResources InterruptibleBuild::resources() {
  BuildResources resources;
  resources.checkpoint_interval = std::chrono::milliseconds(0);
  resources.threads = 1;
  return resources;
}

std::optional<ErrorCode> InterruptibleBuild::run(const BuildResources& resources) const {
  try {
    build({raster_.path()}, output(), options(), resources);
  } catch (const Error& e) {
    return e.code();
  }
  return std::nullopt;
}

void InterruptibleBuild::expect_resumed_to_the_same_bytes() const {
  BuildResources resources = InterruptibleBuild::resources();
  resources.unfinished = Unfinished::kResume;
  resources.overwrite = true;
  EXPECT_EQ(run(resources), std::nullopt);
  EXPECT_TRUE(oracle::bytes_of(output()) == expected_);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"out.ptin"});
}

}  // namespace ptin::test
