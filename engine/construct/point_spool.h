// SPDX-License-Identifier: GPL-3.0-or-later
//
// Points of a source on their way to the grid, which is not known before the last one is read.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/construct/point_sorter.h"
#include "engine/construct/point_stream.h"
#include "storage/file_layer.h"

namespace ptin {

/// A queue on disk: all points in, then all points out, and the disk is free again piece by piece.
class PointSpool {
 public:
  explicit PointSpool(const ExternalMemory& memory) : memory_(memory) {}

  /// @throws Error io_error, resource_exhausted
  void add(const SourcePoint& p);
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// The next points; false when there is none left. No add() after the first take().
  [[nodiscard]] bool take(std::vector<SourcePoint>& batch);

 private:
  /// Three mantissas and the decimals of each.
  static constexpr std::size_t kRecordBytes = 3 * 8 + 3;
  static constexpr std::size_t kBlockRecords = 1 << 15;
  static constexpr std::uint64_t kFileBlocks = 256;
  void flush();

  ExternalMemory memory_;
  std::vector<std::byte> block_;
  std::vector<std::unique_ptr<ScratchFile>> files_;  ///< Of kFileBlocks blocks each.
  std::uint64_t blocks_ = 0;
  std::uint64_t size_ = 0, taken_ = 0;
};

}  // namespace ptin
