// SPDX-License-Identifier: GPL-3.0-or-later
//
// Brings the segments of leaves into their order: batches end as the threads will have it, the file
// is always the same.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "engine/construct/hierarchy/batch_order.h"
#include "engine/construct/hierarchy/build_log.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// Segments of the batch whose turn it is go to the output at once; those of later ones wait in a
/// file each. Threads: add() from several at once, one for each batch.
class InOrderSegments {
 public:
  InOrderSegments(BuildLog& log, const BatchOrder& order);

  /// The next segment of a batch. @throws Error as SegmentOutput::add_segment; io_error
  void add(std::size_t batch, std::span<VertexSplit> records);
  /// The batch's segments are complete: facts of the file in which they wait, if they do.
  [[nodiscard]] ArrayFileFacts end(std::size_t batch);
  /// Writes what has its turn, after the log took note of the batch.
  void advance();
  /// As BuildLog::checkpoint, with no segment being written meanwhile.
  void checkpoint(bool force);

 private:
  [[nodiscard]] TileId top(std::size_t batch) const { return order_.batches()[batch].top; }
  void write_waiting(std::size_t batch, const ArrayFileFacts& facts);

  BuildLog& log_;
  const BatchOrder& order_;
  std::mutex mutex_;  ///< Guards the output and what follows.
  std::size_t turn_;
  std::map<std::size_t, std::unique_ptr<ArrayFileWriter>> waiting_;  ///< Batches being collapsed.
  std::vector<TileId> written_;  ///< Whose files are not needed any more.
};

}  // namespace ptin
