// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bulk-loads the packed R-tree: descriptors of pages come in, in page order; nodes go out.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "storage/descriptor.h"
#include "storage/file/file_layer.h"
#include "storage/index_shape.h"

namespace ptin {

/// Pages come in the order of the file, which is already a spatial one (record_order.h), so that
/// the tree is packed in that order: no sort, and the children of a node are implicit by position.
/// Leaves go to a nameless side file as they fill up. Memory: 64 KiB, and 48 bytes a leaf: less
/// than one byte for a hundred records.
class IndexWriter {
 public:
  /// @param files, folder, stem  Where the side file is made, when there is a first leaf to keep.
  IndexWriter(FileLayer& files, std::string folder, std::string stem,
              const HeightEncoding& heights);

  /// Adds the next page. @throws Error io_error, resource_exhausted
  void add(const layout::NodeEntry& page);
  [[nodiscard]] std::uint64_t pages() const noexcept { return pages_; }

  /// Writes all nodes to `out` from `offset` on, root first. Returns the checksum of the root; 0
  /// without pages. Call once, after the last page.
  std::uint64_t write_to(ScratchFile& out, std::uint64_t offset);

 private:
  void finish_leaf();

  FileLayer& files_;
  std::string folder_, stem_;
  HeightEncoding heights_;
  std::uint64_t pages_ = 0;
  layout::IndexNode leaf_{};
  std::vector<layout::IndexNode> buffer_;   // leaves not yet in the side file
  std::uint64_t spilled_ = 0;               // leaves in the side file
  std::vector<layout::NodeEntry> parents_;  // one for each finished leaf
  std::unique_ptr<ScratchFile> side_file_;
};

}  // namespace ptin
