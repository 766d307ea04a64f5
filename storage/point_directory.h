// SPDX-License-Identifier: GPL-3.0-or-later
//
// The directory of a file, read: from places, or boxes, to the pages that may have living stars there,
// by one node a place.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "storage/attributes.h"
#include "storage/directory_cells.h"
#include "storage/file/io_counters.h"
#include "storage/file/readable_file.h"
#include "storage/index_shape.h"
#include "storage/page_store.h"

namespace ptin {

/// A page as the directory names it. Its stars reach out of `box`.
struct DirectoryPage {
  PageId id{};
  std::uint32_t checksum = 0;  ///< Lower half of the page's.
  GridBox box;                 ///< Holds its stars, as far as they lie in the cell of the place.
  ShortBits error_max = 0;     ///< Not below the largest error of its records.
  ShortBits death_min = 0;     ///< As death_bits(); not above the least death of its triangles.
};

/// Where a directory lies in its file.
struct DirectoryPlace {
  ByteRange root, nodes;
  std::uint64_t root_checksum = 0;
};

/// What a directory says of its cells.
struct DirectoryRoot {
  DirectoryCells cells;
  DirectoryScale scale;
  std::vector<std::uint32_t> checksums;  ///< Lower halves, of the nodes.
  std::vector<std::uint64_t> end;        ///< Entries of a cell and those before it.

  /// Reads and checks it. Cost: one read.
  /// @throws Error corruption, io_error
  [[nodiscard]] static DirectoryRoot read(const ReadableFile& file, const DirectoryPlace& place,
                                          const GridBox& bounds);
  [[nodiscard]] std::uint64_t entries_of(std::uint32_t cell) const noexcept {
    return end[cell] - (cell == 0 ? 0 : end[cell - 1]);
  }
  /// Place of a node, from the beginning of all nodes on.
  [[nodiscard]] ByteRange range_of(std::uint32_t cell) const noexcept {
    return {(end[cell] - entries_of(cell)) * layout::kDirectoryEntryBytes,
            entries_of(cell) * layout::kDirectoryEntryBytes};
  }
};

/// Reads nodes of the directory, and verifies each time what it reads. Threads: const functions may
/// be called at once.
class PointDirectory {
 public:
  /// Reads nothing yet.
  /// @param file   Borrowed, as the shape of which `pages` speaks.
  /// @param pages  How nodes name them.
  PointDirectory(const ReadableFile& file, const DirectoryPlace& place, const GridBox& bounds,
                 const PageNames& pages)
      : file_(file), place_(place), bounds_(bounds), pages_(pages) {}

  /// The pages that may hold living stars at each of some places.
  /// @param places  Within the bounds; each the least box around a point, so at most one unit wide.
  /// @param filter  Filter of the level; nothing else of it is asked.
  /// @param found   As many; each receives the pages of its place, those that probably hold it first.
  /// Cost: the nodes of the places' cells, each once, announced together.
  /// @throws Error corruption, io_error
  void find(std::span<const GridBox> places, const StarFilter& filter,
            std::span<std::vector<DirectoryPage>> found, IoCounters& counters) const;

  /// Appends the pages that may hold what the filter asks for, each once, ascending, with the box of
  /// what lies in the cells that the filter's box meets. Heights are not known here: those of
  /// the filter are not asked, nor its steps.
  /// REQUIRES: filter.also is null, or its reach is known and lies within filter.box.
  /// Cost: as above, of those cells.
  /// @throws Error corruption, io_error
  void find_in(const StarFilter& filter, std::vector<DirectoryPage>& pages,
               IoCounters& counters) const;
  /// Bytes of the nodes that find_in() reads for a box. Cost: that of the cells which the box meets;
  /// the first call reads the root.
  /// @throws Error as find_in()
  [[nodiscard]] std::uint64_t bytes_for(const GridBox& box) const;

 private:
  [[nodiscard]] const DirectoryRoot& root() const;
  [[nodiscard]] ByteRange range_of(const DirectoryRoot& root, std::uint32_t cell) const noexcept;
  template <class Visit>
  void read_node(const DirectoryRoot& root, const DirectoryCells::Cell& cell,
                 const StarFilter& filter, IoCounters& counters, const Visit& visit) const;

  const ReadableFile& file_;
  DirectoryPlace place_;
  GridBox bounds_;
  PageNames pages_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const DirectoryRoot> root_;  ///< Once it was read, it stays.
};

}  // namespace ptin
