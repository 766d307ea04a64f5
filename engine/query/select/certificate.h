// SPDX-License-Identifier: GPL-3.0-or-later
//
// Certificates: how far the TIN of an answer can be from the source, given the records that were
// left out. The bounds come from the file's table of errors (engine/DESIGN.md, section 2.7).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/query/select/retrieval.h"
#include "storage/store_file.h"

namespace ptin {

/// Bounds on the vertical distance between the TIN of an answer and the source, in the height's
/// unit. Both are at least those of the file's finest TIN (base_error, base_deviation).
struct Certificate {
  double error = 0.0;      ///< At every input sample.
  double deviation = 0.0;  ///< At any point.
  bool complete = true;    ///< No record was left out.
};

/// Counts the applied records by the bins of the file's table of errors. What is left out is
/// bounded by the bins that are not complete. Borrows the store.
class AppliedErrors {
 public:
  explicit AppliedErrors(const StoreFile& store);
  void add(float error) noexcept { ++applied_[bin_of(error)]; }
  /// REQUIRES: a record of this error was added and not removed since.
  void remove(float error) noexcept { --applied_[bin_of(error)]; }
  /// Bounds over the whole domain. A bin of which any record was left out counts as a whole. Cost:
  /// the number of bins.
  [[nodiscard]] Certificate certificate() const;

 private:
  /// Bin of an error. Errors above the last bin, which a damaged table can leave, share one more
  /// bin at the end.
  [[nodiscard]] std::size_t bin_of(float error) const noexcept;

  const StoreFile* store_;
  std::vector<std::uint64_t> applied_;
};

/// The certificate of an answer that leaves out, where it was asked, only records of error at most
/// `bound`; a negative `bound` leaves out none. Bins are eighths of an octave: `error` is the upper
/// end of the last bin that may be left out, but never above `bound`.
[[nodiscard]] Certificate certify_below(const StoreFile& store, double bound);

/// The certificate of an answer that applied `splits`, whichever records of the file these are:
/// bounds over the whole domain. A bin of which any record was left out counts as a whole.
[[nodiscard]] Certificate certify_applied(const StoreFile& store,
                                          std::span<const PendingSplit> splits);

/// Whether the file's full TIN may be another than the source's because records were left out. Where
/// heights alone were rounded, as those of doubles are, the rounded ones are the terrain's, and its
/// voids are the source's: both bounds are no larger than that rounding then, which is finer than that
/// of floats. A build that leaves out no more than so little counts as rounding, too.
[[nodiscard]] bool leaves_records_out(const StoreFacts& facts);

}  // namespace ptin
