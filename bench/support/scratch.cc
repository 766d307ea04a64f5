// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/support/scratch.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <unistd.h>

#include "engine/construct/build.h"

namespace ptin::bench {

namespace fs = std::filesystem;

std::string shared_terrain(const std::string& name) {
  const fs::path path = fs::path(PTIN_SHARED_DATA) / name;
  return fs::exists(path) ? path.string() : std::string();
}

ScratchFolder::ScratchFolder() {
  static int count = 0;
  path_ =
      (fs::path(PTIN_BENCH_SCRATCH) / (std::to_string(::getpid()) + "_" + std::to_string(count++)))
          .string();
  fs::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

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
