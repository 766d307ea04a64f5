// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/support/scratch.h"

#include <cstdlib>
#include <filesystem>

#include "engine/construct/build.h"

namespace ptin::bench {

namespace fs = std::filesystem;

std::string shared_terrain(const std::string& name) {
  const fs::path path = fs::path(PTIN_SHARED_DATA) / name;
  return fs::exists(path) ? path.string() : std::string();
}

namespace {

const char* scratch_place() {
  fs::create_directories(PTIN_BENCH_SCRATCH);
  return PTIN_BENCH_SCRATCH;
}

}  // namespace

ScratchFolder::ScratchFolder() : TestFolder(fs::path(scratch_place())) {}

const std::string& bench_store() {
  static const ScratchFolder folder;
  static const std::string path = []() -> std::string {
    if (const char* given = std::getenv("PTIN_BENCH_STORE")) return given;
    const std::string raster = shared_terrain("srtm1_bigtujunga_utm_1197x643.tif");
    if (raster.empty()) return {};
    build({raster}, folder.file("store.ptin"), {}, {});
    return folder.file("store.ptin");
  }();
  return path;
}

}  // namespace ptin::bench
