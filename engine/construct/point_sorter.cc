// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/point_sorter.h"

#include <algorithm>
#include <memory>

#include "engine/error.h"

namespace ptin {

namespace {

constexpr std::size_t kBatch = 4096;

bool is_before(const KeyedHeight& a, const KeyedHeight& b) noexcept {
  return a.key != b.key ? a.key < b.key : a.height < b.height;
}

void check_stop(const std::stop_token& stop) {
  if (stop.stop_requested()) {
    throw Error(ErrorCode::cancelled, "sorting the points was cancelled");
  }
}

}  // namespace

struct PointSorter::Run {
  std::uint64_t next = 0, end = 0;  ///< In the file: what is not in memory yet.
  std::vector<KeyedHeight> buffer;
  std::size_t at = 0;
  std::size_t capacity = 0;
};

PointSorter::PointSorter(const ExternalMemory& memory)
    : memory_(memory),
      capacity_(std::max<std::size_t>(memory.bytes / sizeof(KeyedHeight), kBatch)) {}

PointSorter::~PointSorter() = default;

void PointSorter::write_run() {
  if (!file_) {
    file_ = std::make_unique<ScratchFile>(memory_.files, memory_.folder, "points", true);
  }
  std::sort(buffer_.begin(), buffer_.end(), is_before);
  file_->write_at(std::as_bytes(std::span(buffer_)), written_ * sizeof(KeyedHeight));
  written_ += buffer_.size();
  run_ends_.push_back(written_);
  buffer_.clear();
}

void PointSorter::fill(Run& run) const {
  const std::uint64_t count = std::min<std::uint64_t>(run.capacity, run.end - run.next);
  run.buffer.resize(count);
  run.at = 0;
  file_->read_at(std::as_writable_bytes(std::span(run.buffer)), run.next * sizeof(KeyedHeight));
  run.next += count;
}

void PointSorter::merge_runs(const std::function<void(std::span<const KeyedHeight>)>& sink,
                             const std::stop_token& stop) {
  std::vector<Run> runs(run_ends_.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].next = i == 0 ? 0 : run_ends_[i - 1];
    runs[i].end = run_ends_[i];
    runs[i].capacity = std::max<std::size_t>(capacity_ / runs.size(), 256);
    fill(runs[i]);
  }
  // A heap of the runs' smallest points; its top is replaced by the next of the same run.
  std::vector<std::size_t> heap(runs.size());
  for (std::size_t i = 0; i < heap.size(); ++i) {
    heap[i] = i;
  }
  const auto front = [&](std::size_t i) -> const KeyedHeight& {
    return runs[i].buffer[runs[i].at];
  };
  const auto after = [&](std::size_t a, std::size_t b) { return is_before(front(b), front(a)); };
  std::make_heap(heap.begin(), heap.end(), after);
  std::vector<KeyedHeight> out;
  out.reserve(kBatch);
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), after);
    Run& run = runs[heap.back()];
    // The run goes on as long as it is ahead of all others.
    do {
      out.push_back(run.buffer[run.at++]);
      if (out.size() == kBatch) {
        check_stop(stop);
        sink(out);
        out.clear();
      }
      if (run.at == run.buffer.size()) {
        fill(run);
      }
    } while (!run.buffer.empty() &&
             (heap.size() == 1 || !is_before(front(heap.front()), run.buffer[run.at])));
    if (run.buffer.empty()) {
      heap.pop_back();
    } else {
      std::push_heap(heap.begin(), heap.end(), after);
    }
  }
  if (!out.empty()) {
    sink(out);
  }
}

void PointSorter::merge(const std::function<void(std::span<const KeyedHeight>)>& sink,
                        const std::stop_token& stop) {
  if (!file_) {
    std::sort(buffer_.begin(), buffer_.end(), is_before);
    for (std::size_t i = 0; i < buffer_.size(); i += kBatch) {
      check_stop(stop);
      sink(std::span(buffer_).subspan(i, std::min(kBatch, buffer_.size() - i)));
    }
    buffer_ = {};
    return;
  }
  if (!buffer_.empty()) {
    write_run();
  }
  buffer_ = {};
  merge_runs(sink, stop);
  file_.reset();
}

}  // namespace ptin
