// SPDX-License-Identifier: GPL-3.0-or-later
//
// Brings the segments of batches into the order of batches: threads end batches in any order, and
// the output is always the same.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "engine/construct/hierarchy/batch_order.h"
#include "engine/construct/hierarchy/build_log.h"
#include "engine/construct/scratch/array_file.h"

namespace ptin {

/// One batch has the turn: the first in the order that is not collapsed. Its segments go to the
/// output at once. The segments of a later batch wait in a temporary file, one for each batch.
/// Threads: add() and end() from several at once, each for a batch of its own.
class InOrderSegments {
 public:
  InOrderSegments(BuildLog& log, const BatchOrder& order);

  /// The next segment of a batch; may be changed in place. Its thread prepares it, beside those of
  /// other batches.
  /// @throws Error as SegmentOutput::add; io_error
  void add(std::size_t batch, StarredRecords& records);
  /// To be called when the segments of a batch are complete. Returns the facts of the file in which
  /// they wait; 0 bytes when all of them are in the output.
  [[nodiscard]] ArrayFileFacts end(std::size_t batch);
  /// To be called after the log took note of a collapsed batch. Moves the turn past all batches
  /// that are collapsed, and writes those of their segments that wait.
  void advance();
  /// BuildLog::checkpoint(), while no segment is being written.
  void checkpoint(bool force);

 private:
  [[nodiscard]] TileId top(std::size_t batch) const { return order_.batches()[batch].top; }
  void write_waiting(std::size_t batch, const ArrayFileFacts& facts);

  BuildLog& log_;
  const BatchOrder& order_;
  std::mutex mutex_;  ///< Guards the output and what follows.
  std::size_t turn_;
  /// For each batch in work: the file in which its segments wait; null when none does.
  std::map<std::size_t, std::unique_ptr<ArrayFileWriter>> waiting_;
  std::vector<TileId> written_;  ///< Tops of batches whose files are in the output.
};

}  // namespace ptin
