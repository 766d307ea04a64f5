// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples at scattered grid points, any number of them. They are sorted on disk where they do not
// fit in memory, in an order in which the samples of a window lie together.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <tuple>
#include <vector>

#include "storage/file/external_sorter.h"
#include "storage/file/file_layer.h"
#include "tools/verify/source_samples.h"

namespace ptin::tools {

/// Sorted samples: add() all samples, sort() once, then count() and read(). One thread.
///
/// A key tells where a sample lies: the bounds are halved again and again, as divided() does,
/// down to single grid points, 64 times at most. Which half holds the point is one bit of its key
/// each time. So the samples of a box that comes from halving the bounds are one run of the sorted
/// ones; the samples of another box are in several runs.
class SortedSamples {
 public:
  /// @param facts   Bounds and heights of the terrain; borrowed for the life of the object.
  /// @param memory  Half of it sorts; the other half keeps what was sorted, when it fits there. Its
  ///                folder is written to only when something does not fit.
  /// @param rule    Which height stands for samples on one grid point.
  SortedSamples(const StoreFacts& facts, const ExternalMemory& memory,
                PointMerge rule = PointMerge::kMean);

  /// Adds a sample. REQUIRES: `p` lies within the bounds.
  /// @throws Error io_error, resource_exhausted (disk full)
  void add(GridPoint p, double height);
  /// Sorts all samples. Samples on one grid point become one by the rule; a mean is rounded as
  /// heights are stored. The builder documents the same.
  /// @throws Error as add(); cancelled
  void sort(const std::stop_token& stop);

  /// The number of samples in the closed box. Cost: two searches a run.  @throws Error io_error
  [[nodiscard]] std::uint64_t count(const GridBox& box) const;
  /// The samples in the closed box, in no order. Memory: what it returns.  @throws Error io_error
  [[nodiscard]] std::vector<SourceSample> read(const GridBox& box) const;

 private:
  struct Record {
    std::uint64_t key;
    double height;
  };
  struct NumberedRecord {
    std::uint64_t key;
    double height;
    std::uint64_t number;  ///< For PointMerge::kFirst how many were added before it; else 0.
  };
  struct Before {
    bool operator()(const NumberedRecord& a, const NumberedRecord& b) const {
      return std::tie(a.key, a.number, a.height) < std::tie(b.key, b.number, b.height);
    }
  };
  using Sorter = ExternalSorter<NumberedRecord, Before>;

  /// The samples of one grid point.
  struct Together {
    NumberedRecord first{};
    double lowest = 0.0, highest = 0.0;
    double sum = 0.0;  ///< Sum of code_of().
    std::uint64_t count = 0;
  };

  /// The sorted records [begin, end): those of a box that comes from halving the bounds.
  struct Run {
    GridBox box;
    std::uint64_t key = 0;  ///< The least key that a point of the box can have.
    int depth = 0;          ///< How often the bounds were halved.
    std::uint64_t begin = 0, end = 0;
  };

  [[nodiscard]] std::uint64_t key_of(GridPoint p) const;
  [[nodiscard]] GridPoint point_of(std::uint64_t key) const;
  [[nodiscard]] double mean_of(double sum, std::uint64_t count) const;
  [[nodiscard]] double merged(const Together& samples) const;
  [[nodiscard]] double code_of(double height) const;
  void keep(const Record& record);
  void flush();
  [[nodiscard]] std::vector<Record> load(std::uint64_t begin, std::uint64_t end) const;
  /// The number of the first record whose key is not below `key`.
  [[nodiscard]] std::uint64_t find(std::uint64_t key) const;
  /// Calls visit(run, is_inside) for runs that together hold all samples of `box`. Where
  /// `is_inside` is off, the run is short and may hold samples outside of the box.
  template <typename Visit>
  void visit_runs(const GridBox& box, const Visit& visit) const;

  const StoreFacts& facts_;
  ExternalMemory memory_;
  PointMerge rule_;
  std::unique_ptr<Sorter> sorter_;
  std::uint64_t size_ = 0;  ///< Number of sorted records.
  /// All sorted records, or those that are not in the file yet.
  std::vector<Record> records_;
  std::unique_ptr<ScratchFile> file_;  ///< All records, when memory is too small.
  /// The key of the first record of each block in the file.
  std::vector<std::uint64_t> landmarks_;
};

}  // namespace ptin::tools
