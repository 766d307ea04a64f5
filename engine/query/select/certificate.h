// SPDX-License-Identifier: GPL-3.0-or-later
//
// Certificates: what the records that were left out can be off by, from the file's table of errors
// (engine/DESIGN.md, section 2.7).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/select/retrieval.h"
#include "storage/store_file.h"

namespace ptin {

/// Bounds of an answer, in the height's unit; at least those of the file's finest TIN against its
/// source.
struct Certificate {
  double error = 0.0;      ///< At every input sample.
  double deviation = 0.0;  ///< At any point.
  bool complete = true;    ///< No record was left out.
};

/// How many records of each bin of a file are applied: what is left out is bounded by the bins that
/// are not complete. Borrows the store.
class AppliedErrors {
 public:
  explicit AppliedErrors(const StoreFile& store);
  void add(float error) noexcept { ++applied_[bin_of(error)]; }
  /// REQUIRES: it was added.
  void remove(float error) noexcept { --applied_[bin_of(error)]; }
  /// Bounds over the whole domain. A bin of which any record was left out counts as a whole. Cost:
  /// the number of bins.
  [[nodiscard]] Certificate certificate() const;

 private:
  /// Errors above all bins, which a damaged table can leave, are counted behind them.
  [[nodiscard]] std::size_t bin_of(float error) const noexcept;

  const StoreFile* store_;
  std::vector<std::uint64_t> applied_;
};

/// For an answer that leaves out only records with error <= `bound` (where it was asked); a
/// negative bound: none. Bounds are rounded up to the end of a bin, the eighth of an octave, but
/// never above `bound`.
[[nodiscard]] Certificate certify_below(const StoreFile& store, double bound);

/// For an answer that applied `splits` of the whole file, whichever they are: bounds over the whole
/// domain. A bin of which any record was left out counts as a whole.
[[nodiscard]] Certificate certify_applied(const StoreFile& store,
                                          std::span<const PendingSplit> splits);

}  // namespace ptin
