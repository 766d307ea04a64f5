// SPDX-License-Identifier: GPL-3.0-or-later
//
// Records of one size on disk: written one after the other, read from anywhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/construct/scratch/array_file.h"
#include "engine/construct/scratch/plain_value.h"
#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/checksum.h"
#include "storage/file/external_memory.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// Records of one size in a file: added in order, finished, then read. Threads: after finish(),
/// const members from any number at once.
template <class Record>
class RecordFile {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// In a file without a name in the folder of `memory`; it goes with the object.
  /// @param stem  Stem of the name that errors show.
  /// @throws Error not_found (no such folder), io_error, resource_exhausted
  RecordFile(const ExternalMemory& memory, const std::string& stem)
      : file_(std::make_unique<ScratchFile>(memory.files, memory.folder, stem, true)) {}

  /// In a file of this name, which stays when the object goes.
  /// @throws Error as above, and when a file that is to be new exists already
  RecordFile(FileLayer& files, const std::string& path,
             ScratchFile::Kept kept) requires PlainValue<Record>
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
    if (block_.empty()) {
      return;
    }
    file_->write_at(std::as_bytes(std::span(block_)), written_ * sizeof(Record));
    checksums_.push_back(checksum_of(std::as_bytes(std::span(block_))));
    written_ += block_.size();
    block_.clear();
  }
  /// One for each block of records. Complete after finish().
  [[nodiscard]] const std::vector<std::uint64_t>& checksums() const noexcept { return checksums_; }
  /// @throws Error io_error, resource_exhausted
  void sync() { file_->sync(); }
  /// Takes up the file of another process, which was finished. From then on every block is checked
  /// when something of it is read.
  /// @param path                Path of the same file, for errors.
  /// @param records, checksums  What size() and checksums() were.
  void take_up(const std::string& path, std::uint64_t records,
               std::vector<std::uint64_t> checksums) {
    path_ = path;
    written_ = records;
    checksums_ = std::move(checksums);
    if (checksums_.size() != (records + kBlock - 1) / kBlock ||
        file_->size() != records * sizeof(Record)) {
      refuse_damaged(path_);
    }
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return written_ + block_.size(); }

  /// Reads records `first` to `first` + `count` - 1 into `records`, which gets that length.
  /// @throws Error io_error; corruption  the file was taken up, and is not what was written
  void take(std::uint64_t first, std::uint64_t count, std::vector<Record>& records) const {
    if (path_.empty() || count == 0) {
      records.resize(count);
      file_->read_at(std::as_writable_bytes(std::span(records)), first * sizeof(Record));
      return;
    }
    const std::uint64_t begin = first / kBlock * kBlock;
    const std::uint64_t end = std::min<std::uint64_t>(written_, padded(first + count));
    records.resize(end - begin);
    file_->read_at(std::as_writable_bytes(std::span(records)), begin * sizeof(Record));
    for (std::uint64_t i = begin; i < end; i += kBlock) {
      const auto block = std::span(records).subspan(i - begin, std::min(kBlock, end - i));
      if (checksum_of(std::as_bytes(block)) != checksums_[i / kBlock]) {
        refuse_damaged(path_);
      }
    }
    records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(first - begin));
    records.resize(count);
  }
  /// @throws Error as take()
  [[nodiscard]] Record at(std::uint64_t i) const {
    std::vector<Record> record;
    take(i, 1, record);
    return record.front();
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
  static constexpr std::uint64_t kBlock = 1 << 13;
  static constexpr std::uint64_t padded(std::uint64_t records) {
    return (records + kBlock - 1) / kBlock * kBlock;
  }
  std::unique_ptr<ScratchFile> file_;
  std::vector<Record> block_;
  std::uint64_t written_ = 0;
  std::vector<std::uint64_t> checksums_;
  std::string path_;  ///< Path of a file that was taken up.
};

}  // namespace ptin
