// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/hierarchy/in_order_segments.h"

#include <utility>

namespace ptin {

InOrderSegments::InOrderSegments(BuildLog& log, const BatchOrder& order)
    : log_(log), order_(order), turn_(log.leaves_written()) {}

/// Hands the segments that wait in the file of a batch to the output.
void InOrderSegments::write_waiting(std::size_t batch, const ArrayFileFacts& facts) {
  ArrayFileReader file(log_.path(top(batch), kRecordsEnding), facts);
  while (!file.at_end()) {
    log_.output().add(file.take_copy<std::byte>());
  }
}

void InOrderSegments::add(std::size_t batch, StarredRecords& records) {
  const std::vector<std::byte> prepared = log_.output().prepare(records);
  const std::lock_guard lock(mutex_);
  std::unique_ptr<ArrayFileWriter>& file = waiting_[batch];
  if (batch == turn_) {
    if (file) {  // the batch got the turn while it was being collapsed
      const ArrayFileFacts facts = file->facts();
      file.reset();
      write_waiting(batch, facts);
      written_.push_back(top(batch));
    }
    log_.output().add(prepared);
    return;
  }
  if (!file) {
    file = std::make_unique<ArrayFileWriter>(log_.workspace().files(),
                                             log_.path(top(batch), kRecordsEnding));
  }
  file->put(prepared);
}

ArrayFileFacts InOrderSegments::end(std::size_t batch) {
  const std::lock_guard lock(mutex_);
  ArrayFileFacts facts;
  if (const auto& file = waiting_[batch]) {
    facts = file->facts();
  }
  waiting_.erase(batch);
  return facts;
}

void InOrderSegments::advance() {
  const std::lock_guard lock(mutex_);
  while (turn_ < order_.batches().size() && log_.collapsed().contains(top(turn_))) {
    const ArrayFileFacts& facts = log_.collapsed().at(top(turn_)).records;
    if (facts.bytes > 0) {
      write_waiting(turn_, facts);
      log_.remove_later(top(turn_), kRecordsEnding);
    }
    ++turn_;
    log_.note_written(turn_, 0);
  }
  for (const TileId& id : std::exchange(written_, {})) {
    log_.remove_later(id, kRecordsEnding);
  }
}

void InOrderSegments::checkpoint(bool force) {
  const std::lock_guard lock(mutex_);
  log_.checkpoint(force);
}

}  // namespace ptin
