// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a build over a tree of tiles needs besides the terrain: files that fail or are not synced,
// and an output that keeps records in memory.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/construct/tile_tasks/segment_output.h"
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

/// Segments as they come, and where each ends. "Pages" are their three arrays behind their sizes.
class RecordsInMemory final : public SegmentOutput {
 public:
  [[nodiscard]] const SegmentPacker& packer() const override { return packer_; }
  void add(const PreparedSegment& /*segment*/) override {
    end_ += take_segment(packer_.from(end_));
    ends_[records_.size()] = end_;
  }
  [[nodiscard]] std::uint64_t page_bytes() const override { return end_; }
  [[nodiscard]] nlohmann::json position() const override { return records_.size(); }
  void sync() override {}
  void resume(const nlohmann::json& position) override {
    const auto size = position.get<std::size_t>();
    records_.splits.resize(size);
    records_.ring_end.resize(size);
    records_.corners.resize(size == 0 ? 0 : records_.ring_end.back());
    end_ = size == 0 ? 0 : ends_.at(size);
  }
  [[nodiscard]] const std::vector<VertexSplit>& records() const { return records_.splits; }
  [[nodiscard]] const StarredRecords& starred() const { return records_; }

 private:
  class Packer final : public SegmentPacker {
   public:
    [[nodiscard]] PreparedSegment prepare(StarredRecords& records) const override {
      PreparedSegment segment;
      const auto append = [](std::vector<std::byte>& to, std::span<const std::byte> bytes) {
        to.insert(to.end(), bytes.begin(), bytes.end());
      };
      const auto append_array = [&](const auto& array) {
        const std::size_t size = array.size();
        append(segment.pages, std::as_bytes(std::span(&size, 1)));
        append(segment.pages, std::as_bytes(std::span(array)));
      };
      append_array(records.splits);
      append_array(records.corners);
      append_array(records.ring_end);
      return segment;
    }
    void place(std::span<const std::byte> pages, std::uint64_t offset) const override {
      const std::lock_guard lock(mutex_);
      bytes_.resize(std::max(bytes_.size(), static_cast<std::size_t>(offset) + pages.size()));
      std::copy(pages.begin(), pages.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
    }
    [[nodiscard]] std::vector<std::byte> from(std::size_t begin) const {
      const std::lock_guard lock(mutex_);
      return {bytes_.begin() + static_cast<std::ptrdiff_t>(begin), bytes_.end()};
    }

   private:
    mutable std::mutex mutex_;
    mutable std::vector<std::byte> bytes_;
  };

  /// Takes the segment that the pages begin with, and tells its bytes.
  std::size_t take_segment(const std::vector<std::byte>& pages) {
    std::span<const std::byte> rest(pages);
    const auto before = static_cast<std::uint32_t>(records_.corners.size());
    const auto first = records_.ring_end.size();
    const auto take = [&](auto& to) {
      std::size_t size = 0;
      std::memcpy(&size, rest.data(), sizeof size);
      const std::size_t had = to.size();
      to.resize(had + size);
      const auto bytes = rest.subspan(sizeof size, size * sizeof to[0]);
      std::copy(bytes.begin(), bytes.end(),
                std::as_writable_bytes(std::span(to).subspan(had)).begin());
      rest = rest.subspan(sizeof size + bytes.size());
    };
    take(records_.splits);
    take(records_.corners);
    take(records_.ring_end);
    for (std::size_t i = first; i < records_.ring_end.size(); ++i) {
      records_.ring_end[i] += before;
    }
    return pages.size() - rest.size();
  }

  Packer packer_;
  StarredRecords records_;
  std::size_t end_ = 0;
  std::map<std::size_t, std::size_t> ends_;  ///< Of the bytes, by the number of records.
};

}  // namespace ptin::test
