// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/source_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <nlohmann/json.hpp>

#include "engine/construct/grid/gdal_session.h"
#include "engine/construct/read/input_kind.h"
#include "engine/error.h"
#include "storage/file/file_questions.h"

namespace ptin {

namespace {

namespace fs = std::filesystem;

/// Absolute where it is a file, so that a build can be resumed from another folder.
std::string full_name(const std::string& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored)
             ? fs::path(absolute_path(file)).lexically_normal().string()
             : file;
}

void collect(const std::string& input, std::set<std::string>& files) {
  if (!files.insert(full_name(input)).second || kind_by_name(input)) {
    return;
  }
  const GDALDatasetUniquePtr data(
      GDALDataset::Open(input.c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (!data) {
    return;
  }
  const CPLStringList list(data->GetFileList());
  const bool is_virtual =
      data->GetDriver() != nullptr && EQUAL(data->GetDriver()->GetDescription(), "VRT");
  for (int i = 0; i < list.size(); ++i) {
    if (is_virtual) {
      collect(list[i], files);
    } else {
      files.insert(full_name(list[i]));
    }
  }
}

nlohmann::json facts_of(const std::string& file) {
  std::error_code failure;
  const auto bytes = fs::file_size(file, failure);
  if (!failure) {
    const auto time = fs::last_write_time(file, failure);
    if (!failure) {
      return {file, bytes, time.time_since_epoch().count()};
    }
  }
  VSIStatBufL status;  // of folders, and of what only GDAL knows: archives, servers
  if (VSIStatL(file.c_str(), &status) == 0) {
    return {file, static_cast<std::uint64_t>(status.st_size),
            static_cast<std::int64_t>(status.st_mtime)};
  }
  return {file, 0, 0};
}

}  // namespace

std::vector<std::string> files_of_input(const std::string& input) {
  const GdalSession session;
  std::set<std::string> files;
  collect(input, files);
  return {files.begin(), files.end()};
}

std::vector<std::string> with_folders_opened(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  for (const std::string& input : inputs) {
    if (input == "-") {
      refuse("a source is not read from standard input; write it to a file first, and name that");
    }
    std::error_code ignored;
    std::vector<std::string> tiles;
    if (fs::is_directory(input, ignored)) {
      tiles = paths_in(input);
    }
    std::erase_if(tiles, [](const std::string& path) {
      std::error_code none;
      return point_format_of(path, {}) != PointFormat::kLas || fs::is_directory(path, none);
    });
    std::sort(tiles.begin(), tiles.end());
    if (tiles.empty()) {
      tiles.push_back(input);
    }
    files.insert(files.end(), tiles.begin(), tiles.end());
  }
  return files;
}

void warn_of_repeated(const std::vector<std::string>& inputs, SourceWarnings& warnings) {
  std::set<std::string> seen;
  for (const std::string& input : inputs) {
    std::error_code ignored;
    const fs::path file = fs::canonical(input, ignored);
    if (!seen.insert(ignored ? input : file.string()).second) {
      warnings.add({"repeated_input",
                    "this file is named more than once among the inputs, and is read each time; "
                    "name it once, or the file that was meant",
                    input});
    }
  }
}

nlohmann::json input_fingerprint(const std::vector<std::string>& inputs) {
  nlohmann::json all = nlohmann::json::array();
  for (const std::string& input : inputs) {
    nlohmann::json files = nlohmann::json::array();
    for (const std::string& file : files_of_input(input)) {
      files.push_back(facts_of(file));
    }
    all.push_back({full_name(input), files});
  }
  return all;
}

std::uint64_t bytes_in(const nlohmann::json& input_fingerprint) {
  std::map<std::string, std::uint64_t> bytes;
  for (const nlohmann::json& input : input_fingerprint) {
    for (const nlohmann::json& file : input.at(1)) {
      bytes[file.at(0).get<std::string>()] = file.at(1).get<std::uint64_t>();
    }
  }
  std::uint64_t all = 0;
  for (const auto& [name, size] : bytes) {
    all += size;
  }
  return all;
}

}  // namespace ptin
