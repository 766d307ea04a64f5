// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keeps points on disk until the last one is read: the grid is not known before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/scratch/array_file.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// Bytes of a point on disk: three mantissas and the decimals of each.
inline constexpr std::size_t kSpooledBytes = 3 * 8 + 3;
/// Points of a block, which are read together; the last block of a file may have fewer.
inline constexpr std::uint64_t kSpoolBlock = 4096;

[[nodiscard]] constexpr std::uint64_t spool_blocks(std::uint64_t points) noexcept {
  return (points + kSpoolBlock - 1) / kSpoolBlock;
}

/// Writes points in blocks of two arrays. Memory: a block.
class SpoolWriter {
 public:
  /// A file of that name is replaced.  @throws Error io_error, resource_exhausted
  SpoolWriter(FileLayer& files, const std::string& path) : file_(files, path) {}

  /// @throws Error io_error, resource_exhausted
  void add(const SourcePoint& p);
  /// Writes the last block, and closes the file.  @throws Error io_error, resource_exhausted
  [[nodiscard]] ArrayFileFacts finish();

 private:
  void flush();

  ArrayFileWriter file_;
  std::vector<std::int64_t> mantissas_;
  std::vector<std::uint8_t> decimals_;
};

/// Passes over the next `blocks` blocks of a spool.  @throws Error corruption  there are fewer
void skip_blocks(ArrayFileReader& spool, std::uint64_t blocks);
/// Reads the next block of a spool.
/// @throws Error corruption  it is not what was written
void read_block(ArrayFileReader& spool, std::vector<SourcePoint>& points);

}  // namespace ptin
