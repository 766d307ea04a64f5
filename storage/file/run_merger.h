// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorted runs of records on disk, merged.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "storage/file/file_layer.h"

namespace ptin {

/// Records `next` .. `end` - 1 of a file, in ascending order.
struct SortedRun {
  std::shared_ptr<const ScratchFile> file;
  std::uint64_t next = 0, end = 0;
};

/// Merges sorted runs to one ascending sequence, by `Before`.
template <class Record, class Before>
class RunMerger {
 public:
  /// @param runs     None of them empty.
  /// @param records  How many records the buffers of all runs hold together; at least one for each
  ///     run.
  /// @throws Error io_error
  RunMerger(std::vector<SortedRun> runs, std::size_t records) {
    cursors_.reserve(runs.size());
    const std::size_t share = records / runs.size();
    for (SortedRun& run : runs) {
      cursors_.emplace_back(std::move(run), share);
      heap_.push_back(heap_.size());
    }
    std::make_heap(heap_.begin(), heap_.end(), After{*this});
  }
  RunMerger(const RunMerger&) = delete;
  RunMerger& operator=(const RunMerger&) = delete;

  /// Adds the next records to `out` until it holds `most`, or none is left.  @throws Error io_error
  void take(std::vector<Record>& out, std::size_t most) {
    const After after{*this};
    while (!heap_.empty() && out.size() < most) {
      std::pop_heap(heap_.begin(), heap_.end(), after);
      Cursor& run = cursors_[heap_.back()];
      // The run goes on as long as it is ahead of all others.
      do {
        out.push_back(run.front());
        run.advance();
      } while (!run.is_over() && out.size() < most &&
               (heap_.size() == 1 || !before_(cursors_[heap_.front()].front(), run.front())));
      if (run.is_over()) {
        heap_.pop_back();
      } else {
        std::push_heap(heap_.begin(), heap_.end(), after);
      }
    }
  }

 private:
  /// A place in a run, with a buffer of the records from there on.
  class Cursor {
   public:
    Cursor(SortedRun run, std::size_t most) : run_(std::move(run)) {
      buffer_.resize(std::min<std::uint64_t>(most, run_.end - run_.next));
      fill();
    }
    [[nodiscard]] const Record& front() const { return buffer_[at_]; }
    [[nodiscard]] bool is_over() const noexcept { return at_ == buffer_.size(); }
    void advance() {
      if (++at_ == buffer_.size() && run_.next < run_.end) {
        fill();
      }
    }

   private:
    void fill() {
      buffer_.resize(std::min<std::uint64_t>(buffer_.size(), run_.end - run_.next));
      at_ = 0;
      run_.file->read_at(std::as_writable_bytes(std::span(buffer_)), run_.next * sizeof(Record));
      run_.next += buffer_.size();
      if (run_.next == run_.end) {
        run_.file.reset();  // the last run of a file frees its disk
      }
    }

    SortedRun run_;
    std::vector<Record> buffer_;
    std::size_t at_ = 0;
  };

  /// The order of a heap of runs whose front has the smallest record.
  struct After {
    const RunMerger& merger;
    bool operator()(std::size_t a, std::size_t b) const {
      return merger.before_(merger.cursors_[b].front(), merger.cursors_[a].front());
    }
  };

  [[no_unique_address]] Before before_;
  std::vector<Cursor> cursors_;
  std::vector<std::size_t> heap_;
};

}  // namespace ptin
