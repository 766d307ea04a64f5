// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build over a tree of tiles needs besides the terrain: a folder, and an output that keeps
// records in memory.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/segment_output.h"
#include "storage/file_layer.h"

namespace ptin::test {

/// A new folder, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "ptin-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      std::abort();
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Files that are never synced: tests survive no power cut anyway.
class UnsyncedFiles : public FileLayer {
 public:
  int sync(int) noexcept override { return 0; }
  int sync_folder(const std::string&) noexcept override { return 0; }
};

/// Segments as they come, and where each ends.
class RecordsInMemory final : public SegmentOutput {
 public:
  void add_segment(std::span<VertexSplit> records) override {
    records_.insert(records_.end(), records.begin(), records.end());
  }
  [[nodiscard]] nlohmann::json position() const override { return records_.size(); }
  void sync() override {}
  void resume(const nlohmann::json& position) override {
    records_.resize(position.get<std::size_t>());
  }
  [[nodiscard]] const std::vector<VertexSplit>& records() const { return records_; }

 private:
  std::vector<VertexSplit> records_;
};

}  // namespace ptin::test
