// SPDX-License-Identifier: GPL-3.0-or-later
//
// The descriptors of the pages that a build has written already, in a file of their own, so that an
// interrupted build can go on where it was.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/file/file_layer.h"
#include "storage/layout.h"

namespace ptin {

/// How much of an unfinished store is safely on disk.
struct StoreCheckpoint {
  std::uint64_t pages = 0;
  /// A checksum over the descriptors of these pages, made by hashing each descriptor together with
  /// the checksum of those before it. Descriptors hold the checksums of their pages, so it stands
  /// for the content of the pages too.
  std::uint64_t chain = 0;
  friend bool operator==(const StoreCheckpoint&, const StoreCheckpoint&) = default;
};

/// Written before publish() puts the front of the file over the first pages: says where copies of
/// those pages are.
struct PublishMark {
  std::uint64_t magic = 0;
  std::uint64_t pages = 0;
  std::uint64_t moved_bytes = 0;  ///< From the start of the file ...
  std::uint64_t moved_to = 0;     ///< ... to this offset.
  std::uint64_t checksum = 0;     ///< Checksum of the fields above.
};

/// An append-only file of descriptors. Memory: at most 4096 descriptors.
class PageJournal {
 public:
  /// Creates or opens the file `path` (ScratchFile::Kept). `files` is borrowed.
  /// @throws Error io_error, resource_exhausted, not_found
  PageJournal(FileLayer& files, const std::string& path, ScratchFile::Kept kept);

  void add(const layout::NodeEntry& page);
  [[nodiscard]] const StoreCheckpoint& end() const noexcept { return end_; }
  /// Writes what was added, and syncs the file.  @throws Error io_error, resource_exhausted
  void sync();
  /// Appends a mark behind all descriptors, and syncs the file.
  void mark(std::uint64_t moved_bytes, std::uint64_t moved_to);

  /// The mark at the end of the file; none when the file does not end with a sound one.
  [[nodiscard]] std::optional<PublishMark> find_mark() const;
  /// Calls page(descriptor) for the first `checkpoint.pages` descriptors, in order, then cuts the
  /// file behind them.
  /// @throws Error corruption  they are not those of the checkpoint
  void replay(const StoreCheckpoint& checkpoint,
              const std::function<void(const layout::NodeEntry&)>& page);

 private:
  void write_pending();

  std::string path_;
  ScratchFile file_;
  StoreCheckpoint end_;
  std::uint64_t written_ = 0;
  std::vector<layout::NodeEntry> pending_;
};

}  // namespace ptin
