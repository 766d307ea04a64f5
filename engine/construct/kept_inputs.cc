// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/kept_inputs.h"

#include <filesystem>
#include <optional>
#include <vector>

#include <gdal_priv.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/construct/grid/gdal_session.h"
#include "engine/error.h"

namespace ptin {

namespace {

struct FileIdentity {
  dev_t device;
  ino_t inode;
  bool operator==(const FileIdentity&) const = default;
};

/// The identity of a file; none where no regular file has this name, as for WKT or a file still to
/// be made.
std::optional<FileIdentity> identity_of(const std::string& path) {
  struct stat status {};
  const int failure = path == "-" ? fstat(STDIN_FILENO, &status) : stat(path.c_str(), &status);
  if (failure != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileIdentity{status.st_dev, status.st_ino};
}

/// The files that a VRT is made of. Other formats are not opened, since their drivers may read a
/// whole file to open it.
std::vector<std::string> files_behind(const std::string& path) {
  if (!EQUAL(std::filesystem::path(path).extension().c_str(), ".vrt")) return {};
  const GdalSession session;
  const char* drivers[] = {"VRT", "OGR_VRT", nullptr};
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR, drivers));
  std::vector<std::string> files;
  if (!data) return files;
  char** const list = data->GetFileList();
  for (char** file = list; file != nullptr && *file != nullptr; ++file) files.emplace_back(*file);
  CSLDestroy(list);
  return files;
}

void check_input(const std::string& input, const std::string& output,
                 const FileIdentity& identity) {
  if (identity_of(input) == identity) {
    throw Error(ErrorCode::invalid_argument,
                "this output is the input " + (input == "-" ? "on standard input" : input) +
                    " and would destroy it; give another name",
                output);
  }
}

}  // namespace

void check_inputs_are_kept(std::span<const std::string> inputs, const std::string& output) {
  const std::optional<FileIdentity> identity = output == "-" ? std::nullopt : identity_of(output);
  if (!identity) return;
  for (const std::string& input : inputs) {
    check_input(input, output, *identity);
    for (const std::string& file : files_behind(input)) check_input(file, output, *identity);
  }
}

}  // namespace ptin
