// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/query/built_terrain.h"

#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include <unistd.h>

#include "engine/construct/build.h"
#include "engine/query/questions.h"

namespace ptin::reference {

namespace {

/// The file is removed with the object.
struct BuiltTerrain {
  BuiltTerrain(const std::string& name, double max_error, const std::string& where) : path(where) {
    BuildOptions options;
    options.max_error = max_error;
    BuildResources resources;
    resources.overwrite = true;
    build({PTIN_TEST_DATA "/" + name}, path, options, resources);
    terrain = std::make_unique<Terrain>(Terrain::open(path));
  }
  ~BuiltTerrain() {
    terrain.reset();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  BuiltTerrain(const BuiltTerrain&) = delete;
  BuiltTerrain& operator=(const BuiltTerrain&) = delete;

  std::string path;
  std::unique_ptr<Terrain> terrain;
};

}  // namespace

const Terrain& built_terrain(const std::string& name, double max_error) {
  static std::map<std::pair<std::string, double>, std::unique_ptr<BuiltTerrain>> all;
  std::unique_ptr<BuiltTerrain>& built = all[{name, max_error}];
  if (!built) {
    const std::string file =
        "ptin_built_" + std::to_string(::getpid()) + "_" + std::to_string(all.size()) + ".ptin";
    built = std::make_unique<BuiltTerrain>(
        name, max_error, (std::filesystem::temp_directory_path() / file).string());
  }
  return *built->terrain;
}

}  // namespace ptin::reference
