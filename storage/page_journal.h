// SPDX-License-Identifier: GPL-3.0-or-later
//
// The descriptors of pages that are on disk already, kept beside them so that an interrupted build
// can go on where it was.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/file/file_layer.h"
#include "storage/layout.h"

namespace ptin {

/// How far a store in the making is safely on disk.
struct StoreCheckpoint {
  std::uint64_t pages = 0;
  /// Over the descriptors of these pages, each hashed with what came before it; they hold the
  /// checksums of the pages.
  std::uint64_t chain = 0;
  friend bool operator==(const StoreCheckpoint&, const StoreCheckpoint&) = default;
};

/// Said before the first pages are overwritten by the front of the file: where their copies are.
struct PublishMark {
  std::uint64_t magic = 0;
  std::uint64_t pages = 0;
  std::uint64_t moved_bytes = 0;  ///< From the start of the file ...
  std::uint64_t moved_to = 0;     ///< ... to this offset.
  std::uint64_t checksum = 0;     ///< Of the fields above.
};

/// Append-only file of descriptors. Memory: what was added since the last sync().
class PageJournal {
 public:
  /// @throws Error io_error, resource_exhausted, not_found
  PageJournal(FileLayer& files, const std::string& path, ScratchFile::Kept kept);

  void add(const layout::NodeEntry& page);
  [[nodiscard]] const StoreCheckpoint& end() const noexcept { return end_; }
  /// Writes and syncs what was added.
  void sync();
  /// Appends and syncs a mark.
  void mark(std::uint64_t moved_bytes, std::uint64_t moved_to);

  /// The mark at the end of the file, if there is one.
  [[nodiscard]] std::optional<PublishMark> find_mark() const;
  /// Hands over the first `checkpoint.pages` descriptors, then forgets what follows them.
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
