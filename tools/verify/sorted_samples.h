// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples at scattered grid points, any number of them: sorted on disk where they do not fit in
// memory, in an order in which the samples of a window lie together.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "engine/construct/scratch/external_sorter.h"
#include "storage/file/file_layer.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// The two halves of a box, cut across its longer side: the lower (or left) one first.
/// REQUIRES: two grid points or more.
[[nodiscard]] std::array<GridBox, 2> halves_of(const GridBox& box);

/// add() all samples, sort() once, then count() and read(). One thread.
///
/// The bounds are halved again and again, as halves_of() does, down to single grid points: 64 times
/// at most. Which half holds a point is one bit of its key each time, so the samples of a box that
/// comes from halving the bounds are one run of the sorted ones, and other boxes are some runs.
class SortedSamples {
 public:
  /// @param facts   Bounds and heights of the terrain; outlive this.
  /// @param memory  Half sorts; the other half keeps what was sorted, when it fits there. Its
  ///                folder is written to only when something does not fit.
  SortedSamples(const StoreFacts& facts, const ExternalMemory& memory);

  /// REQUIRES: within the bounds.  @throws Error io_error, resource_exhausted (disk full)
  void add(GridPoint p, double height);
  /// Samples on one grid point become one, at their mean height, rounded as heights are stored, as
  /// the builder documents.
  /// @throws Error as add(); cancelled
  void sort(const std::stop_token& stop);

  /// Samples in the closed box.  Cost: two searches a run.  @throws Error io_error
  [[nodiscard]] std::uint64_t count(const GridBox& box) const;
  /// Those samples, in no order.  Memory: what it returns.  @throws Error io_error
  [[nodiscard]] std::vector<Sample> read(const GridBox& box) const;

 private:
  struct Record {
    std::uint64_t key;
    double height;
  };
  struct Before {
    bool operator()(const Record& a, const Record& b) const {
      return a.key != b.key ? a.key < b.key : a.height < b.height;
    }
  };
  using Sorter = ExternalSorter<Record, Before>;

  /// Records [begin, end) of the sorted ones: those of a box that comes from halving the bounds.
  struct Run {
    GridBox box;
    std::uint64_t key = 0;  ///< Least that a point of the box can have.
    int depth = 0;          ///< How often the bounds were halved.
    std::uint64_t begin = 0, end = 0;
  };

  [[nodiscard]] std::uint64_t key_of(GridPoint p) const;
  [[nodiscard]] GridPoint point_of(std::uint64_t key) const;
  [[nodiscard]] double mean_of(double sum, std::uint64_t count) const;
  [[nodiscard]] double code_of(double height) const;
  void keep(const Record& record);
  void flush();
  [[nodiscard]] std::vector<Record> load(std::uint64_t begin, std::uint64_t end) const;
  /// First record with a key of `key` or more.
  [[nodiscard]] std::uint64_t find(std::uint64_t key) const;
  /// Calls `visit(run, is_inside)` for runs that together hold the box: short ones, which may hold
  /// samples around it, where `is_inside` is off.
  template <typename Visit>
  void visit_runs(const GridBox& box, const Visit& visit) const;

  const StoreFacts& facts_;
  ExternalMemory memory_;
  std::unique_ptr<Sorter> sorter_;
  std::uint64_t size_ = 0;                ///< Of sorted records.
  std::vector<Record> records_;           ///< All of them, or those not yet written.
  std::unique_ptr<ScratchFile> file_;     ///< All of them, when they do not fit in memory.
  std::vector<std::uint64_t> landmarks_;  ///< Key of each block's first record, of those in a file.
};

}  // namespace ptin::tools
