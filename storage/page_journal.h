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
  /// How many were added.
  [[nodiscard]] std::uint64_t pages() const noexcept { return pages_; }
  /// A checksum over the descriptors, made by hashing each one together with the checksum of those
  /// before it. Descriptors hold the checksums of their pages, so it stands for the content of the
  /// pages too.
  [[nodiscard]] std::uint64_t chain() const noexcept { return chain_; }
  /// Writes what was added, and syncs the file.  @throws Error io_error, resource_exhausted
  void sync();
  /// Appends a mark behind all descriptors, and syncs the file.
  void mark(std::uint64_t moved_bytes, std::uint64_t moved_to);

  /// The mark at the end of the file; none when the file does not end with a sound one.
  [[nodiscard]] std::optional<PublishMark> find_mark() const;
  /// Calls page(descriptor) for the first `pages` descriptors, in order, then cuts the file behind
  /// them.
  /// @throws Error corruption  their chain() is another one
  void replay(std::uint64_t pages, std::uint64_t chain,
              const std::function<void(const layout::NodeEntry&)>& page);

 private:
  void write_pending();

  std::string path_;
  ScratchFile file_;
  std::uint64_t pages_ = 0, chain_ = 0;
  std::uint64_t written_ = 0;
  std::vector<layout::NodeEntry> pending_;
};

}  // namespace ptin
