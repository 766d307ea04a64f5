// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorts any number of records in bounded memory: sorted runs on disk, merged.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/error.h"
#include "storage/file_layer.h"

namespace ptin {

/// Where a step of reading or sorting keeps its temporary files, and how much memory it may take.
struct ExternalMemory {
  FileLayer& files;
  std::string folder;  ///< Must exist. Files in it have no names: they are gone with the process.
  std::uint64_t bytes = std::uint64_t{64} << 20;
};

/// add() in any order, then take() or merge() everything once. With `Before` a total order on what
/// the records hold, the result depends on the set of records alone.
template <class Record, class Before>
class ExternalSorter {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// @param stem  Of the names of its files, for errors.
  explicit ExternalSorter(const ExternalMemory& memory, std::string stem = "sorted")
      : memory_(memory),
        stem_(std::move(stem)),
        capacity_(std::max<std::size_t>(memory.bytes / sizeof(Record), kBatch)) {}

  /// @throws Error io_error, resource_exhausted (the disk is full)
  void add(const Record& record) {
    if (buffer_.size() == capacity_) {
      write_run();
    }
    if (buffer_.size() == buffer_.capacity()) {  // doubled, but never beyond what it may take
      buffer_.reserve(std::clamp<std::size_t>(2 * buffer_.size(), kBatch, capacity_));
    }
    buffer_.push_back(record);
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return written_ + buffer_.size(); }

  /// The next records in ascending order, some thousands; false when there is none left. No add()
  /// after the first call.
  /// @throws Error as add(), cancelled
  /// Cost of all: O(n log n); nothing is written unless there is more than fits in memory.
  [[nodiscard]] bool take(std::vector<Record>& batch, const std::stop_token& stop = {}) {
    if (!is_merging_) {
      begin_merge();
    }
    if (stop.stop_requested()) {
      throw Error(ErrorCode::cancelled, "sorting was cancelled");
    }
    batch.clear();
    if (file_) {
      merge_runs(batch);
    } else {
      const std::size_t end = std::min(buffer_.size(), taken_ + kBatch);
      batch.assign(buffer_.begin() + static_cast<std::ptrdiff_t>(taken_),
                   buffer_.begin() + static_cast<std::ptrdiff_t>(end));
      taken_ = end;
    }
    if (batch.empty()) {
      buffer_ = {};
      runs_ = {};
      file_.reset();
      written_ = 0;
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

 private:
  static constexpr std::size_t kBatch = 4096;
  static constexpr std::size_t kLeastOfRun = 256;

  struct Run {
    std::uint64_t next = 0, end = 0;  ///< In the file: what is not in memory yet.
    std::vector<Record> buffer;
    std::size_t at = 0;
    std::size_t capacity = 0;
    [[nodiscard]] const Record& front() const { return buffer[at]; }
  };

  void write_run() {
    if (!file_) {
      file_ = std::make_unique<ScratchFile>(memory_.files, memory_.folder, stem_, true);
    }
    std::sort(buffer_.begin(), buffer_.end(), before_);
    file_->write_at(std::as_bytes(std::span(buffer_)), written_ * sizeof(Record));
    written_ += buffer_.size();
    run_ends_.push_back(written_);
    buffer_.clear();
  }

  void fill(Run& run) const {
    const std::uint64_t count = std::min<std::uint64_t>(run.capacity, run.end - run.next);
    run.buffer.resize(count);
    run.at = 0;
    file_->read_at(std::as_writable_bytes(std::span(run.buffer)), run.next * sizeof(Record));
    run.next += count;
  }

  void begin_merge() {
    is_merging_ = true;
    if (!file_) {
      std::sort(buffer_.begin(), buffer_.end(), before_);
      return;
    }
    if (!buffer_.empty()) {
      write_run();
    }
    buffer_ = {};
    runs_.resize(run_ends_.size());
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      runs_[i].next = i == 0 ? 0 : run_ends_[i - 1];
      runs_[i].end = run_ends_[i];
      runs_[i].capacity = std::max<std::size_t>(capacity_ / runs_.size(), kLeastOfRun);
      fill(runs_[i]);
      heap_.push_back(i);
    }
    std::make_heap(heap_.begin(), heap_.end(), After{*this});
  }

  /// For a heap of the runs' smallest records.
  struct After {
    const ExternalSorter& sorter;
    bool operator()(std::size_t a, std::size_t b) const {
      return sorter.before_(sorter.runs_[b].front(), sorter.runs_[a].front());
    }
  };

  void merge_runs(std::vector<Record>& out) {
    const After after{*this};
    while (!heap_.empty() && out.size() < kBatch) {
      std::pop_heap(heap_.begin(), heap_.end(), after);
      Run& run = runs_[heap_.back()];
      // The run goes on as long as it is ahead of all others.
      do {
        out.push_back(run.buffer[run.at++]);
        if (run.at == run.buffer.size()) {
          fill(run);
        }
      } while (!run.buffer.empty() && out.size() < kBatch &&
               (heap_.size() == 1 || !before_(runs_[heap_.front()].front(), run.front())));
      if (run.buffer.empty()) {
        heap_.pop_back();
      } else {
        std::push_heap(heap_.begin(), heap_.end(), after);
      }
    }
  }

  ExternalMemory memory_;
  std::string stem_;
  std::size_t capacity_;
  [[no_unique_address]] Before before_;
  std::vector<Record> buffer_;
  std::unique_ptr<ScratchFile> file_;
  std::vector<std::uint64_t> run_ends_;  ///< In records, in the file.
  std::uint64_t written_ = 0;
  bool is_merging_ = false;
  std::size_t taken_ = 0;
  std::vector<Run> runs_;
  std::vector<std::size_t> heap_;
};

}  // namespace ptin
