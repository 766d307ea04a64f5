// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sorts any number of points in bounded memory: sorted runs on disk, merged.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "storage/file_layer.h"

namespace ptin {

/// A point to be sorted: by key, then height.
struct KeyedHeight {
  std::uint64_t key = 0;
  double height = 0.0;  ///< No NaN.
  friend bool operator==(const KeyedHeight&, const KeyedHeight&) = default;
};

/// Where a step of reading or sorting keeps its temporary files, and how much memory it may take.
struct ExternalMemory {
  FileLayer& files;
  std::string folder;  ///< Must exist. Files in it have no names: they are gone with the process.
  std::uint64_t bytes = std::uint64_t{64} << 20;
};

/// add() in any order, then merge() once. The order of equal points is no matter, so the result
/// depends on the set of points alone.
class PointSorter {
 public:
  explicit PointSorter(const ExternalMemory& memory);
  ~PointSorter();
  PointSorter(const PointSorter&) = delete;
  PointSorter& operator=(const PointSorter&) = delete;

  /// @throws Error io_error, resource_exhausted (the disk is full)
  void add(KeyedHeight point) {
    if (buffer_.size() == capacity_) {
      write_run();
    }
    buffer_.push_back(point);
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return written_ + buffer_.size(); }

  /// Hands out everything in ascending order, some thousands at a time.
  /// @throws Error as add(), cancelled, and what `sink` throws
  /// Cost: O(n log n); nothing is written unless there is more than fits in memory.
  void merge(const std::function<void(std::span<const KeyedHeight>)>& sink,
             const std::stop_token& stop = {});

 private:
  struct Run;
  void write_run();
  void merge_runs(const std::function<void(std::span<const KeyedHeight>)>& sink,
                  const std::stop_token& stop);
  void fill(Run& run) const;

  ExternalMemory memory_;
  std::size_t capacity_;
  std::vector<KeyedHeight> buffer_;
  std::unique_ptr<ScratchFile> file_;
  std::vector<std::uint64_t> run_ends_;  ///< In points, in the file.
  std::uint64_t written_ = 0;
};

}  // namespace ptin
