// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keeps points on disk until the last one is read: the grid is not known before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/points/point_files.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// Bytes of a point on disk: three mantissas and the decimals of each.
inline constexpr std::size_t kSpooledBytes = 3 * 8 + 3;
/// Points of a block, which are read together; the last block of a file may have fewer.
inline constexpr std::uint64_t kSpoolBlock = 4096;

[[nodiscard]] constexpr std::uint64_t spool_blocks(std::uint64_t points) noexcept {
  return (points + kSpoolBlock - 1) / kSpoolBlock;
}

/// Writes points in blocks, each with its checksum behind it, so that no reader needs to know all of
/// them. Memory: a block.
class SpoolWriter {
 public:
  /// A file of that name is replaced.  @throws Error io_error, resource_exhausted
  /// @param number  Of the spool: a block of another one is none of this.
  SpoolWriter(FileLayer& files, const std::string& path, std::uint64_t number);

  /// @throws Error io_error, resource_exhausted
  void add(const SourcePoint& p);
  /// Writes the last block, and closes the file.  @throws Error io_error, resource_exhausted
  void finish();

 private:
  void flush();

  ScratchFile file_;
  std::uint64_t number_;
  std::vector<std::byte> block_;
  std::uint64_t blocks_ = 0;  ///< Written so far.
};

/// Reads them back.
class SpoolReader {
 public:
  /// @throws Error corruption  the file has not the length of so many points; not_found, io_error
  SpoolReader(const PointFiles& files, std::uint64_t number, std::uint64_t points);

  /// @param points  Receives the points of a block.
  /// @throws Error corruption  the block is not what was written; io_error
  void read(std::uint64_t block, std::vector<SourcePoint>& points);

 private:
  std::uint64_t number_;
  std::string path_;
  std::unique_ptr<ScratchFile> file_;
  std::uint64_t points_;
  std::vector<std::byte> bytes_;
};

}  // namespace ptin
