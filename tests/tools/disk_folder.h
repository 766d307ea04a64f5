// SPDX-License-Identifier: GPL-3.0-or-later
//
// A folder whose files can be dropped from the page cache.
#pragma once

#include <filesystem>
#include <memory>

#include "tests/tools/program.h"
#include "tools/measure/file_cache.h"

namespace ptin::tools::testing {

/// Null where neither the system's temporary folder nor the working one is on a disk:
/// `GTEST_SKIP() << kNeedsDisk`.
inline std::unique_ptr<TestFolder> disk_folder() {
  for (const std::filesystem::path& parent :
       {std::filesystem::temp_directory_path(), std::filesystem::current_path()}) {
    auto folder = std::make_unique<TestFolder>(parent);
    write_file(folder->file("x"), std::string(10000, 'x'));
    if (FileCache(folder->file("x")).why_never_cold().empty()) {
      std::filesystem::remove(folder->file("x"));
      return folder;
    }
  }
  return nullptr;
}
inline constexpr const char* kNeedsDisk = "needs a folder on a disk, to drop files from the cache";

}  // namespace ptin::tools::testing
