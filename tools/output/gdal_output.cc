// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/output/gdal_output.h"

#include <cstdint>

#include <gdal_priv.h>
#include <sys/statvfs.h>

#include "storage/file/file_questions.h"
#include "tools/output/output_file.h"
#include "tools/output/standard_output.h"

namespace ptin::tools {

bool is_disk_full(const std::string& path) {
  constexpr std::uint64_t kNearlyNothing = std::uint64_t{1} << 20;
  struct statvfs status {};
  return statvfs(folder_of(path).c_str(), &status) == 0 &&
         std::uint64_t{status.f_bavail} * status.f_frsize < kNearlyNothing;
}

Error gdal_failure(const std::string& action, const std::string& path, bool was_disk_full) {
  const std::string said = CPLGetLastErrorMsg();
  if (path == "-") finish_stdout();  // says why, where standard output is at fault
  if (was_disk_full || said.find("disk is full") != std::string::npos ||
      said.find("No space left") != std::string::npos ||
      said.find("File too large") != std::string::npos || is_disk_full(path)) {
    return {ErrorCode::resource_exhausted,
            action + ": the disk is full; make room or choose another folder", path};
  }
  return {ErrorCode::io_error, said.empty() ? action : action + ": " + said, path};
}

void require_done(CPLErr result, const std::string& action, const std::string& path) {
  if (result != CE_None) throw gdal_failure(action, path);
}

GDALDriver& driver_named(const char* name) {
  GDALDriver* found = GetGDALDriverManager()->GetDriverByName(name);
  if (found == nullptr) {
    throw Error(ErrorCode::io_error,
                std::string("GDAL has no driver ").append(name).append("; install a full GDAL"));
  }
  return *found;
}

}  // namespace ptin::tools
