// SPDX-License-Identifier: GPL-3.0-or-later
//
// Shares the points of a source out among the ranges of the curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/construct/grid/point_sorter.h"
#include "engine/construct/points/point_files.h"
#include "engine/construct/points/sort_plan.h"
#include "engine/construct/scratch/array_file.h"
#include "engine/construct/tasks/task.h"

namespace ptin {

/// What came of one share.
struct ShareCounts {
  std::uint64_t records = 0;   ///< That were written.
  std::uint64_t left_out = 0;  ///< Beyond the boundary.
  double largest_shift_plan = 0.0;
};

/// Some records of one range, one after the other in the file of a share.
struct ShareBlock {
  std::uint64_t offset = 0;  ///< Bytes.
  std::uint64_t records = 0;
  std::uint64_t checksum = 0;
};

/// The points of a share of the source, the one of plan.shares that the task has the number of: a place
/// along the curve and a height for each, to a file in which the records of a range lie together,
/// and what is where to a file beside it; likewise some of the vertices of lines. Left out are
/// points that fall on such a vertex, or beyond the boundary. Memory: plan.ranges() *
/// plan.block_records records.
/// @return  The facts of the latter file.
/// @throws Error corruption, not_found, io_error, resource_exhausted, cancelled
[[nodiscard]] ArrayFileFacts share_out(const SortPlan& plan, const PointFiles& files,
                                       const Task& task);

/// What a share counted.  @throws Error corruption, not_found, io_error
[[nodiscard]] ShareCounts counts_of_share(const PointFiles& files, std::size_t share,
                                          const ArrayFileFacts& facts);

/// The records of one range in all shares.
class RangeOfShares {
 public:
  /// @throws Error corruption, not_found, io_error
  RangeOfShares(const PointFiles& files, const std::vector<ArrayFileFacts>& shares,
                std::size_t range);

  [[nodiscard]] std::uint64_t records() const noexcept { return records_; }
  /// Calls take(records) with some at a time, in no order.
  /// @throws Error corruption, not_found, io_error, and what `take` throws
  template <class Record, class Take>
  void read(const Take& take) const {
    std::vector<Record> records;
    for (std::size_t share = 0; share < blocks_.size(); ++share) {
      if (blocks_[share].empty()) {
        continue;
      }
      const std::string path = files_.path("share", share);
      const auto file = files_.open(path);
      for (const ShareBlock& block : blocks_[share]) {
        records.resize(static_cast<std::size_t>(block.records));
        read_block(*file, path, block, std::as_writable_bytes(std::span(records)));
        take(std::span<const Record>(records));
      }
    }
  }

 private:
  static void read_block(const ScratchFile& file, const std::string& path, const ShareBlock& block,
                         std::span<std::byte> bytes);

  const PointFiles& files_;
  std::vector<std::vector<ShareBlock>> blocks_;  ///< By share.
  std::uint64_t records_ = 0;
};

}  // namespace ptin
