// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/companion_files.h"

#include <cerrno>
#include <filesystem>
#include <initializer_list>

#include <unistd.h>

#include "engine/error.h"
#include "tools/output/file_name.h"

namespace ptin::tools {

std::vector<std::string> companions_of(const std::string& path) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& stem, std::initializer_list<const char*> endings) {
    for (const char* ending : endings) names.push_back(stem + ending);
  };
  const std::string extension = lower_extension(path);
  add(path, {".aux.xml"});
  if (extension == ".tif" || extension == ".tiff") add(path, {".ovr", ".msk", ".msk.ovr"});
  if (extension == ".gpkg") add(path, {"-wal", "-shm", "-journal"});
  if (extension == ".shp") {
    const std::string stem = std::filesystem::path(path).replace_extension().string();
    add(stem, {".prj", ".cpg", ".qpj", ".qix", ".sbn", ".sbx", ".idm", ".ind"});
    add(stem, {".PRJ", ".CPG", ".QPJ", ".QIX", ".SBN", ".SBX", ".IDM", ".IND"});
  }
  return names;
}

void remove_companions(const std::string& path) {
  for (const std::string& name : companions_of(path)) {
    if (unlink(name.c_str()) != 0 && errno != ENOENT) {
      throw system_error(errno, "cannot remove what belongs to the file to be replaced", name);
    }
  }
}

}  // namespace ptin::tools
