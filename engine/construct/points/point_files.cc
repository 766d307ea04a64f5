// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/points/point_files.h"

#include <filesystem>

#include "storage/file/file_questions.h"

namespace ptin {

namespace {

constexpr const char* kPrefix = "sort.";

}  // namespace

std::string PointFiles::path(const char* kind, std::size_t number) const {
  return folder + "/" + kPrefix + kind + "-" + std::to_string(number);
}

bool PointFiles::is_one(const std::string& path) const {
  return path.starts_with(folder + "/" + kPrefix);
}

std::unique_ptr<ScratchFile> PointFiles::open(const std::string& path) const {
  if (await) {
    await(path);
  }
  return std::make_unique<ScratchFile>(files, path, ScratchFile::Kept::kExisting);
}

ArrayFileReader PointFiles::open(const std::string& path, const ArrayFileFacts& facts) const {
  if (await) {
    await(path);
  }
  return ArrayFileReader(path, facts);
}

void PointFiles::remove_all() const { remove_all(""); }

void PointFiles::remove_all(const std::string& kind) const {
  remove_files(files, folder + "/" + kPrefix + kind + (kind.empty() ? "" : "-"));
}

void remove_files(FileLayer& files, const std::string& path) {
  const std::string begin = std::filesystem::path(path).filename().string();
  for (const std::string& found : paths_in(folder_of(path))) {
    if (std::filesystem::path(found).filename().string().starts_with(begin)) {
      without_old(files, found);
    }
  }
}

}  // namespace ptin
