// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/construct/resume_fixture.h"

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/construct/hierarchy_fixture.h"

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

std::string scattered_points() {
  std::mt19937 random(7);
  std::string text;
  for (int i = 0; i < 1200; ++i) {
    const auto x = random() % 1000, y = random() % 1000;
    const std::string line =
        std::to_string(x) + " " + std::to_string(y) + " " + std::to_string((x * y) % 97) + "\n";
    text += i % 50 == 0 ? line + line : line;
  }
  return text;
}

std::string triangles_with_holes() {
  constexpr int kSide = 35;
  std::mt19937 random(11);
  std::string text;
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto x = static_cast<unsigned>(i % kSide) * 20 + random() % 8;
    const auto y = static_cast<unsigned>(i / kSide) * 20 + random() % 8;
    text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
            std::to_string((x * y) % 97) + "\n";
  }
  for (int i = 0; i < kSide * (kSide - 1); ++i) {
    if (i % kSide == kSide - 1 || random() % 7 == 0) {
      continue;
    }
    const int a = i + 1, b = i + 2, c = i + 2 + kSide, d = i + 1 + kSide;
    for (const auto& f : {std::array{a, b, c}, std::array{a, c, d}}) {
      text += "f " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " +
              std::to_string(f[2]) + "\n";
    }
  }
  return text;
}

}  // namespace

namespace {

/// The raster of every build of one, which none changes.
const std::string& path_of_raster() {
  static const oracle::WrittenRaster raster(hills_with_a_lake());
  return raster.path();
}

/// What a build that nobody interrupts writes. It is the same each time, since the file names its
/// source without the folder, so it runs once a process.
const std::string& expected_of(const std::string& input, const BuildOptions& options) {
  static std::map<std::string, std::string> all;
  const auto [found, is_new] = all.try_emplace(std::filesystem::path(input).filename().string() +
                                               (options.boundary.empty() ? "" : " with lines"));
  if (is_new) {
    const oracle::ScratchFolder folder;
    const std::string plain = folder.file("plain.ptin");
    UnsyncedFiles files;
    BuildResources resources;
    resources.files = &files;
    build({input}, plain, options, resources);
    found->second = oracle::bytes_of(plain);
  }
  return found->second;
}

}  // namespace

InterruptibleBuild::InterruptibleBuild(SourceKind kind) : kind_(kind) {
  if (kind == SourceKind::kRaster) {
    input_ = path_of_raster();
  } else if (kind == SourceKind::kPoints || kind == SourceKind::kLines) {
    input_ = source_folder_.file("points.xyz");
    oracle::write_text(input_, scattered_points());
    oracle::write_text(source_folder_.file("lines.csv"),
                       "id,WKT\n1,\"LINESTRING Z (20 30 50,930 870 20,950 200 30)\"\n"
                       "2,\"LINESTRING Z (10 700 40,300 340 90)\"\n");
    oracle::write_text(
        source_folder_.file("area.csv"),
        "id,WKT\n1,\"POLYGON Z ((0 0 9,990 30 9,970 990 9,500 700 9,0 980 9,0 0 9))\"\n");
  } else {
    input_ = source_folder_.file("mesh.obj");
    oracle::write_text(input_, triangles_with_holes());
  }
  expected_ = &expected_of(input_, options());
}

BuildOptions InterruptibleBuild::options() const {
  BuildOptions options;
  options.tile = kind_ == SourceKind::kRaster ? 16 : 10;
  if (kind_ == SourceKind::kPoints) {
    options.max_edge = 60.0;
  }
  if (kind_ == SourceKind::kLines) {
    options.breaklines = {source_folder_.file("lines.csv")};
    options.boundary = source_folder_.file("area.csv");
  }
  return options;
}

BuildResources InterruptibleBuild::resources() {
  BuildResources resources;
  resources.checkpoint_interval = std::chrono::milliseconds(0);
  resources.threads = 1;
  return resources;
}

std::optional<ErrorCode> InterruptibleBuild::run(BuildResources resources) const {
  UnsyncedFiles files;
  if (resources.files == nullptr) {
    resources.files = &files;
  }
  try {
    build({input_}, output(), options(), resources);
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
  EXPECT_TRUE(oracle::bytes_of(output()) == *expected_);
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"out.ptin"});
}

}  // namespace ptin::test
