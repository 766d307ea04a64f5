// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build over a tree of tiles needs besides the terrain: files that fail or are not synced,
// and an output that keeps records in memory.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/hierarchy/segment_output.h"
#include "storage/file/file_layer.h"

namespace ptin::test {

/// Files that are never synced: tests survive no power cut anyway.
class UnsyncedFiles : public FileLayer {
 public:
  int sync(int) noexcept override { return 0; }
  int sync_folder(const std::string&) noexcept override { return 0; }
};

/// From the n-th call on everything fails but closing and removing, as on a disk that is full or
/// gone; half of the first failing write gets through.
class FailingFiles final : public FileLayer {
 public:
  explicit FailingFiles(int nth) : nth_(nth) {}
  /// Calls so far that could have failed.
  [[nodiscard]] int calls() const { return calls_; }

  int create(const std::string& path, int& fd) noexcept override {
    return fails() ? ENOSPC : FileLayer::create(path, fd);
  }
  int create_nameless(const std::string& folder, int& fd) noexcept override {
    return fails() ? ENOSPC : FileLayer::create_nameless(folder, fd);
  }
  int open(const std::string& path, int& fd) noexcept override {
    return fails() ? EIO : FileLayer::open(path, fd);
  }
  int write_at(int fd, std::span<const std::byte> bytes, std::uint64_t offset,
               std::size_t& written) noexcept override {
    if (fails()) {
      static_cast<void>(FileLayer::write_at(fd, bytes.first(bytes.size() / 2), offset, written));
      written = 0;
      return ENOSPC;
    }
    return FileLayer::write_at(fd, bytes, offset, written);
  }
  int read_at(int fd, std::span<std::byte> bytes, std::uint64_t offset,
              std::size_t& read) noexcept override {
    return fails() ? EIO : FileLayer::read_at(fd, bytes, offset, read);
  }
  int allocate(int fd, std::uint64_t offset, std::uint64_t bytes) noexcept override {
    return fails() ? ENOSPC : FileLayer::allocate(fd, offset, bytes);
  }
  int truncate(int fd, std::uint64_t bytes) noexcept override {
    return fails() ? EIO : FileLayer::truncate(fd, bytes);
  }
  int sync(int) noexcept override { return fails() ? EIO : 0; }
  int rename(const std::string& from, const std::string& to, bool replace) noexcept override {
    return fails() ? EIO : FileLayer::rename(from, to, replace);
  }
  int make_folder(const std::string& path) noexcept override {
    return fails() ? ENOSPC : FileLayer::make_folder(path);
  }
  int sync_folder(const std::string&) noexcept override { return fails() ? EIO : 0; }

 private:
  bool fails() noexcept { return ++calls_ >= nth_; }
  int nth_;
  int calls_ = 0;
};

/// Segments as they come, and where each ends.
class RecordsInMemory final : public SegmentOutput {
 public:
  void add_segment(StarredRecords& records) override {
    const auto before = static_cast<std::uint32_t>(records_.corners.size());
    const auto append = [](const auto& from, auto& to) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(records.splits, records_.splits);
    append(records.corners, records_.corners);
    for (const std::uint32_t end : records.ring_end) {
      records_.ring_end.push_back(before + end);
    }
  }
  [[nodiscard]] nlohmann::json position() const override { return records_.size(); }
  void sync() override {}
  void resume(const nlohmann::json& position) override {
    const auto size = position.get<std::size_t>();
    records_.splits.resize(size);
    records_.ring_end.resize(size);
    records_.corners.resize(size == 0 ? 0 : records_.ring_end.back());
  }
  [[nodiscard]] const std::vector<VertexSplit>& records() const { return records_.splits; }
  [[nodiscard]] const StarredRecords& starred() const { return records_; }

 private:
  StarredRecords records_;
};

}  // namespace ptin::test
