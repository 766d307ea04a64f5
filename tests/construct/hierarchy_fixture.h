// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build over a tree of tiles needs besides the terrain: files that fail or are not synced,
// and an output that keeps records in memory.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
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
  /// The three arrays behind their sizes.
  [[nodiscard]] std::vector<std::byte> prepare(StarredRecords& records) const override {
    std::vector<std::byte> bytes;
    const auto append = [&](const auto& array) {
      const std::size_t size = array.size();
      for (const auto part :
           {std::as_bytes(std::span(&size, 1)), std::as_bytes(std::span(array))}) {
        bytes.insert(bytes.end(), part.begin(), part.end());
      }
    };
    append(records.splits);
    append(records.corners);
    append(records.ring_end);
    return bytes;
  }
  void add(std::span<const std::byte> prepared) override {
    const auto before = static_cast<std::uint32_t>(records_.corners.size());
    const auto first = records_.ring_end.size();
    const auto take = [&](auto& to) {
      std::size_t size = 0;
      std::memcpy(&size, prepared.data(), sizeof size);
      const std::size_t had = to.size();
      to.resize(had + size);
      const auto bytes = prepared.subspan(sizeof size, size * sizeof to[0]);
      std::copy(bytes.begin(), bytes.end(),
                std::as_writable_bytes(std::span(to).subspan(had)).begin());
      prepared = prepared.subspan(sizeof size + bytes.size());
    };
    take(records_.splits);
    take(records_.corners);
    take(records_.ring_end);
    for (std::size_t i = first; i < records_.ring_end.size(); ++i) {
      records_.ring_end[i] += before;
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
