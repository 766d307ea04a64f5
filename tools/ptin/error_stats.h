// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file's table of errors tells: quantiles of the errors, and the number of vertices that a
// tolerance takes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "storage/store_file.h"

namespace ptin::tools {

/// The vertices of T0 plus the records with error above `tolerance`. The bin that holds the
/// tolerance counts as a whole, so the result may be too large, by at most the records of an eighth
/// of an octave.
[[nodiscard]] std::uint64_t vertices_at(const StoreFile& store, double tolerance);

/// The error that `share` (0 to 1) of the records do not exceed, rounded up to the end of its bin;
/// may be +infinity.
[[nodiscard]] double error_quantile(const StoreFile& store, double share);

/// Records of error 0: without them no sample differs. Most of them lie in flat parts.
struct FlatRecords {
  std::uint64_t records = 0;
  std::uint64_t bytes = 0;  ///< Their share of the file.
  /// What to give as --max-error so that a build leaves them out, and little else: a power of ten
  /// below every other error, and far below a step between heights. None where there are none.
  std::optional<double> max_error;
};
/// @throws Error corruption as metadata_of()
[[nodiscard]] FlatRecords flat_records(const StoreFile& store);

/// The largest finite upper end of a bin that has records; 0 when there is none.
[[nodiscard]] double largest_finite_error(const StoreFile& store);

/// Tolerances of 1, 2 or 5 times a power of ten that make a difference to this file, ascending: at
/// most `count` of them, the largest ones.
[[nodiscard]] std::vector<double> round_tolerances(const StoreFile& store, std::size_t count);

}  // namespace ptin::tools
