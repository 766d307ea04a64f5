// SPDX-License-Identifier: GPL-3.0-or-later
//
// Makes the directory of a store whose pages are all there.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "storage/directory_cells.h"
#include "storage/file/file_layer.h"
#include "storage/store_writer.h"

namespace ptin {

/// Plans a directory, then writes it: its length is known before the pages find their places.
/// Memory: 2 MiB of points, kDirectoryRunBytes, 30 bytes a cell.
class DirectoryWriter {
 public:
  /// @param walk  Goes over the pages, several times; borrowed, as are their descriptors.
  /// None where it would be too long, whatever the cells.
  [[nodiscard]] static std::optional<DirectoryWriter> plan(const GridBox& bounds,
                                                           std::uint64_t pages,
                                                           std::uint32_t page_bytes,
                                                           const DirectoryOptions& options,
                                                           const PageWalk& walk);

  [[nodiscard]] std::uint64_t root_bytes() const noexcept;
  [[nodiscard]] std::uint64_t node_bytes() const noexcept;
  /// Writes the nodes, one behind the other. Returns the checksum of their bytes.
  /// @param walk  As plan(), but with names for numbers (PageNames).
  /// @throws Error io_error, resource_exhausted
  std::uint64_t write_nodes(const PageWalk& walk, ScratchFile& out, std::uint64_t offset);
  /// The directory's own section, once the nodes were written.
  [[nodiscard]] std::vector<std::byte> root() const;

 private:
  DirectoryWriter(DirectoryCells cells, std::vector<std::uint64_t> entries,
                  const DirectoryScale& scale)
      : cells_(std::move(cells)), entries_(std::move(entries)), scale_(scale) {}

  DirectoryCells cells_;
  std::vector<std::uint64_t> entries_;
  DirectoryScale scale_;
  std::vector<std::uint32_t> checksums_;
};

}  // namespace ptin
