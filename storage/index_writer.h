// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bulk-loads the packed R-tree: descriptors of pages come in, in page order; nodes go out.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "storage/descriptor.h"
#include "storage/directory_cells.h"
#include "storage/file/file_layer.h"
#include "storage/index_shape.h"

namespace ptin {

/// Builds the packed R-tree over pages in the order in which they come. That is the order of the
/// file, which is a spatial one already (storage/record_order.h): so nothing is sorted, and the
/// children of a node follow from its position. A leaf has pages of one segment. Leaves go to a nameless side file as they fill up.
/// Memory: 64 KiB, and 48 bytes for each leaf, which is less than one byte for a hundred records.
class IndexWriter {
 public:
  /// @param files, folder, stem  Where the side file is made, once there are 16 leaves; `files` is
  /// borrowed.
  IndexWriter(FileLayer& files, std::string folder, std::string stem,
              const HeightEncoding& heights);

  /// Adds the next page. @throws Error io_error, resource_exhausted
  void add(const layout::NodeEntry& page);
  /// Says that what comes next belongs to another segment. One of fewer than 112 pages, or less than a
  /// 512th of all up to here, goes on with the next.
  /// @throws Error io_error, resource_exhausted
  void end_segment();
  /// Says that there are no more pages. Before shape().  @throws Error io_error, resource_exhausted
  void finish();
  /// Pages of each segment as it was cut.
  [[nodiscard]] const std::vector<std::uint64_t>& segments() const noexcept { return segments_; }
  [[nodiscard]] std::uint64_t pages() const noexcept { return pages_; }

  /// Calls visit(page, descriptor) for all pages, in order. Before write_to(). Cost: reads the side
  /// file.
  /// @throws Error io_error
  void walk(const PageVisitor& visit) const;

  /// Writes all nodes to `out` from `offset` on, the root first. Returns the checksum of the root,
  /// or 0 when there are no pages. Call once, after finish().
  /// @throws Error io_error, resource_exhausted
  std::uint64_t write_to(ScratchFile& out, std::uint64_t offset);

 private:
  void finish_leaf();
  void cut();

  FileLayer& files_;
  std::string folder_, stem_;
  HeightEncoding heights_;
  std::uint64_t pages_ = 0;
  std::uint64_t segment_pages_ = 0;      // of the last segment
  std::uint32_t segment_leaves_ = 0;     // of these the finished leaves
  std::vector<std::uint64_t> segments_;  // those before it
  layout::IndexNode leaf_{};
  std::vector<layout::IndexNode> buffer_;   // leaves not yet in the side file
  std::uint64_t spilled_ = 0;               // leaves in the side file
  std::vector<layout::NodeEntry> parents_;  // one for each finished leaf
  std::unique_ptr<ScratchFile> side_file_;
};

}  // namespace ptin
