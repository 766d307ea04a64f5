// SPDX-License-Identifier: GPL-3.0-or-later
//
// Records of one size on disk: written one after the other, read from anywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/construct/scratch/external_memory.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/checksum.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// Records of one size in a file: added in order, finished, then read. Threads: after finish(),
/// const members from any number at once.
template <class Record>
class RecordFile {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// In a file without a name in the folder of `memory`; it goes with the object.
  /// @param stem  Of the name that errors show.
  /// @throws Error not_found (no such folder), io_error, resource_exhausted
  RecordFile(const ExternalMemory& memory, const std::string& stem)
      : file_(std::make_unique<ScratchFile>(memory.files, memory.folder, stem, true)) {}

  /// In a file of this name, which stays when the object goes.
  /// @throws Error as above, and when a file that is to be new exists already
  RecordFile(FileLayer& files, const std::string& path, ScratchFile::Kept kept)
      : file_(std::make_unique<ScratchFile>(files, path, kept)) {}

  /// @throws Error io_error, resource_exhausted (the disk is full)
  void add(const Record& record) {
    block_.push_back(record);
    if (block_.size() == kBlock) {
      finish();
    }
  }
  /// Writes what add() still holds. To be called after the last record.
  /// @throws Error as add()
  void finish() {
    file_->write_at(std::as_bytes(std::span(block_)), written_ * sizeof(Record));
    add_to_checksum(block_);
    written_ += block_.size();
    block_.clear();
  }
  /// Of all records, block by block. Complete after finish().
  [[nodiscard]] std::uint64_t checksum() const noexcept { return checksum_; }
  /// @throws Error io_error, resource_exhausted
  void sync() { file_->sync(); }
  /// Takes up the file of an earlier process, which was finished: reads all of it. False when it is
  /// not what was written.
  /// @param path               Of the same file.
  /// @param records, checksum  What size() and checksum() were.
  /// @throws Error io_error, cancelled
  [[nodiscard]] bool take_up(const std::string& path, std::uint64_t records, std::uint64_t checksum,
                             const std::stop_token& stop) {
    std::error_code ignored;
    if (std::filesystem::file_size(path, ignored) != records * sizeof(Record)) {
      return false;
    }
    written_ = records;
    std::vector<Record> block;
    for (std::uint64_t i = 0; i < records; i += block.size()) {
      stop_if_asked(stop, "reading temporary files");
      take(i, std::min<std::uint64_t>(kBlock, records - i), block);
      add_to_checksum(block);
    }
    return checksum_ == checksum;
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return written_ + block_.size(); }

  /// Reads records `first` to `first` + `count` - 1 into `records`, which gets that length.
  /// @throws Error io_error
  void take(std::uint64_t first, std::uint64_t count, std::vector<Record>& records) const {
    records.resize(count);
    file_->read_at(std::as_writable_bytes(std::span(records)), first * sizeof(Record));
  }
  [[nodiscard]] Record at(std::uint64_t i) const {
    Record record;
    file_->read_at(std::as_writable_bytes(std::span(&record, 1)), i * sizeof(Record));
    return record;
  }
  /// Calls visit(record) for all of them, in their order.
  /// @throws Error io_error, cancelled, and what `visit` throws
  template <class Visit>
  void visit(const Visit& visit, const std::stop_token& stop) const {
    std::vector<Record> records;
    for (std::uint64_t i = 0; i < size(); i += records.size()) {
      stop_if_asked(stop, "reading temporary files");
      take(i, std::min<std::uint64_t>(kBlock, size() - i), records);
      for (const Record& record : records) {
        visit(record);
      }
    }
  }

 private:
  static constexpr std::size_t kBlock = 1 << 13;
  void add_to_checksum(const std::vector<Record>& block) {
    if (!block.empty()) {
      const std::array<std::uint64_t, 2> link{checksum_,
                                              checksum_of(std::as_bytes(std::span(block)))};
      checksum_ = checksum_of_object(link);
    }
  }
  std::unique_ptr<ScratchFile> file_;
  std::vector<Record> block_;
  std::uint64_t written_ = 0;
  std::uint64_t checksum_ = 0;
};

}  // namespace ptin
