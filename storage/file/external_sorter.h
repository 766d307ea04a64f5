// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorts any number of records in bounded memory: sorted runs on disk, merged.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/error.h"
#include "engine/stop.h"
#include "storage/file/external_memory.h"
#include "storage/file/file_layer.h"
#include "storage/file/run_merger.h"

namespace ptin {

/// What sorting took.
struct SortCounts {
  std::uint64_t runs = 0;     ///< Sorted in memory and written.
  std::uint64_t merges = 0;   ///< Merges to longer runs on disk; not the last, which hands out.
  std::uint64_t written = 0;  ///< Records; each counts as often as it was written.
  std::size_t widest = 0;     ///< Most runs merged at a time.
  std::size_t held = 0;       ///< Most records in memory at a time.
};

/// Takes records by add() in any order, then hands all of them out once, in ascending order, by
/// take() or merge(). With `Before` a total order on what the records hold, the result depends on
/// the set of records alone.
///
/// Runs of as many records as fit into memory are sorted and written. At most most_runs() runs are
/// merged at a time: as many as can have kLeastOfRun records each in that memory. When so many runs
/// are there and one more is to come, all of them become one run of the next level, whose runs are
/// treated likewise. Sorting n records in the memory of m thus writes each of them 1 + log(n / m) /
/// log(m / 256) times, rounded down: once up to n = m^2 / 256.
template <class Record, class Before = std::less<>>
class ExternalSorter {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// @param memory  Folder and bytes for records. Where the bytes are fewer than kLeastRecords
  ///     records take, it takes these all the same.
  /// @param stem    Stem of the names of its files, for errors.
  /// @param stop    Looked at where add() merges.
  explicit ExternalSorter(const ExternalMemory& memory, std::string stem = "sorted",
                          std::stop_token stop = {})
      : memory_(memory),
        stem_(std::move(stem)),
        stop_(std::move(stop)),
        capacity_(std::max<std::size_t>(memory.bytes / sizeof(Record), kLeastRecords) - kBatch) {}

  /// @throws Error io_error, resource_exhausted (the disk is full), cancelled
  void add(const Record& record) {
    if (buffer_.size() == buffer_.capacity() && !grow()) {
      write_run();
      if (levels_.front().runs.size() == most_runs()) {  // and there will be one more
        lift(0);
      }
      static_cast<void>(grow());
    }
    buffer_.push_back(record);
    ++size_;
  }
  /// So many records will come: as many as fit get their room at once. To be called before add().
  void expect(std::uint64_t records) {
    buffer_.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(records, capacity_)));
    note_held(buffer_.capacity());
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] const SortCounts& counts() const noexcept { return counts_; }

  /// Gives the next records in ascending order, up to kBatch of them; false when none is left. No
  /// add() after the first call.
  /// @throws Error as add(), cancelled
  /// Cost of all: O(n log n); nothing is written unless there is more than fits in memory.
  [[nodiscard]] bool take(std::vector<Record>& batch, const std::stop_token& stop = {}) {
    if (!is_merging_) {
      begin_merge(stop);
    }
    check(stop);
    batch.clear();
    if (last_) {
      last_->take(batch, kBatch);
    } else {
      const std::size_t end = std::min(buffer_.size(), taken_ + kBatch);
      batch.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(taken_),
                   buffer_.begin() + static_cast<std::ptrdiff_t>(end));
      taken_ = end;
    }
    if (batch.empty()) {
      buffer_ = std::vector<Record>();
      last_.reset();
      size_ = 0;
      taken_ = 0;
    }
    return !batch.empty();
  }

  /// Hands out everything, as take().  @throws Error as take(), and what `sink` throws
  template <class Sink>
  void merge(const Sink& sink, const std::stop_token& stop = {}) {
    std::vector<Record> batch;
    while (take(batch, stop)) {
      sink(std::span<const Record>(batch));
    }
  }

  /// Records that are handed out or copied at a time.
  static constexpr std::size_t kBatch = 4096;
  /// Least number of records of a run in memory while it is merged.
  static constexpr std::size_t kLeastOfRun = 256;
  /// Least number of records that are held in memory, whatever the limit.
  static constexpr std::size_t kLeastRecords = 2 * kBatch;

 private:
  using Merger = RunMerger<Record, Before>;

  /// Runs of about one length, in one file.
  struct Level {
    std::shared_ptr<ScratchFile> file;
    std::uint64_t written = 0;
    std::vector<SortedRun> runs;
  };

  static void check(const std::stop_token& stop) { stop_if_asked(stop, "sorting"); }
  [[nodiscard]] std::size_t most_runs() const noexcept { return capacity_ / kLeastOfRun; }
  void note_held(std::size_t records) { counts_.held = std::max(counts_.held, records); }

  /// Makes the buffer larger; false when it is as large as it may be. While it moves, its old and
  /// its new room count together.
  bool grow() {
    const std::size_t now = buffer_.capacity();
    const std::size_t most = capacity_ - now;
    const std::size_t wanted = levels_.empty() ? std::min(most, std::max(2 * now, kBatch)) : most;
    if (wanted <= now) {
      return false;
    }
    buffer_.reserve(wanted);
    note_held(now + wanted);
    return true;
  }

  void write_run() {
    std::sort(buffer_.begin(), buffer_.end(), before_);
    if (levels_.empty()) {
      levels_.emplace_back();
    }
    begin_run(levels_.front());
    append(levels_.front(), buffer_);
    ++counts_.runs;
    buffer_ = std::vector<Record>();  // so that the next one can take all memory; {} would keep it
  }

  void begin_run(Level& level) {
    if (!level.file) {
      level.file = std::make_shared<ScratchFile>(memory_.files, memory_.folder, stem_, true);
    }
    level.runs.push_back({level.file, level.written, level.written});
  }
  void append(Level& level, const std::vector<Record>& records) {
    level.file->write_at(std::as_bytes(std::span(records)), level.written * sizeof(Record));
    level.written += records.size();
    level.runs.back().end = level.written;
    counts_.written += records.size();
  }

  /// Merges all runs of a level to one run of the next. REQUIRES: the buffer is empty.
  void lift(std::size_t level) {
    if (level + 1 == levels_.size()) {
      levels_.emplace_back();
    }
    std::vector<SortedRun> runs = std::exchange(levels_[level], Level()).runs;
    merge_to(levels_[level + 1], std::move(runs), stop_);
    if (levels_[level + 1].runs.size() == most_runs()) {
      lift(level + 1);
    }
  }

  void merge_to(Level& to, std::vector<SortedRun> runs, const std::stop_token& stop) {
    note_merge(runs.size());
    ++counts_.merges;
    Merger merger(std::move(runs), capacity_);
    begin_run(to);
    std::vector<Record> batch;
    do {
      check(stop);
      batch.clear();
      merger.take(batch, kBatch);
      append(to, batch);
    } while (!batch.empty());
  }
  void note_merge(std::size_t runs) {
    counts_.widest = std::max(counts_.widest, runs);
    note_held(capacity_ + kBatch);
  }

  void begin_merge(const std::stop_token& stop) {
    is_merging_ = true;
    if (levels_.empty()) {
      std::sort(buffer_.begin(), buffer_.end(), before_);
      return;
    }
    if (!buffer_.empty()) {
      write_run();
    }
    std::vector<SortedRun> runs;  // the shortest first
    for (Level& level : levels_) {
      std::move(level.runs.begin(), level.runs.end(), std::back_inserter(runs));
    }
    levels_.clear();
    while (runs.size() > most_runs()) {  // merges few, so that the rest can be merged at once
      const std::size_t count = std::min(most_runs(), runs.size() - most_runs() + 1);
      const auto end = runs.begin() + static_cast<std::ptrdiff_t>(count);
      std::vector<SortedRun> first(std::make_move_iterator(runs.begin()),
                                   std::make_move_iterator(end));
      runs.erase(runs.begin(), end);
      Level merged;
      merge_to(merged, std::move(first), stop);
      runs.push_back(std::move(merged.runs.front()));
    }
    note_merge(runs.size());
    last_.emplace(std::move(runs), capacity_);
  }

  ExternalMemory memory_;
  std::string stem_;
  std::stop_token stop_;
  std::size_t capacity_;  ///< Records in the buffer, or in those of all runs that are merged.
  [[no_unique_address]] Before before_;
  std::vector<Record> buffer_;
  std::vector<Level> levels_;
  std::uint64_t size_ = 0;
  SortCounts counts_;
  bool is_merging_ = false;
  std::size_t taken_ = 0;
  std::optional<Merger> last_;
};

}  // namespace ptin
