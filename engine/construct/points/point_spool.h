// SPDX-License-Identifier: GPL-3.0-or-later
//
// Keeps points on disk until the last one is read: the grid is not known before.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/construct/grid/source_point.h"
#include "engine/construct/read/point_stream.h"
#include "engine/construct/scratch/external_memory.h"
#include "storage/file/file_layer.h"

namespace ptin {

/// A queue on disk: all points in, then all points out. As points are taken out, the disk is freed
/// piece by piece.
class PointSpool {
 public:
  /// Bytes of a point on disk: three mantissas and the decimals of each.
  static constexpr std::size_t kRecordBytes = 3 * 8 + 3;

  explicit PointSpool(const ExternalMemory& memory) : memory_(memory) {}

  /// @throws Error io_error, resource_exhausted
  void add(const SourcePoint& p);
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// The next points, in the order of add(); false when there is none left. No add() after the
  /// first take().  @throws Error io_error, resource_exhausted
  [[nodiscard]] bool take(std::vector<SourcePoint>& batch);

 private:
  static constexpr std::size_t kBlockRecords = 1 << 15;
  /// Files are small, so that their disk is freed early, and few, since each has a descriptor. The
  /// first kFilesOfSize files have kFileBlocks blocks, the next kFilesOfSize twice as many, and so
  /// on: 2 TB are 256 files.
  static constexpr std::uint64_t kFileBlocks = 256;
  static constexpr std::size_t kFilesOfSize = 32;
  struct File {
    std::unique_ptr<ScratchFile> file;
    std::uint64_t first_block = 0, blocks = 0;
  };
  void flush();

  ExternalMemory memory_;
  std::vector<std::byte> block_;
  std::vector<File> files_;
  std::size_t taking_ = 0;  ///< The file that is being taken from.
  std::uint64_t blocks_ = 0;
  std::uint64_t size_ = 0, taken_ = 0;
};

}  // namespace ptin
