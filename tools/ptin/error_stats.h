// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file's table of errors tells: quantiles of the errors, and the number of vertices that a
// tolerance takes.
#pragma once

#include <cstdint>
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

/// The largest finite upper end of a bin that has records; 0 when there is none.
[[nodiscard]] double largest_finite_error(const StoreFile& store);

/// Tolerances of 1, 2 or 5 times a power of ten that make a difference to this file, ascending: at
/// most `count` of them, the largest ones.
[[nodiscard]] std::vector<double> round_tolerances(const StoreFile& store, std::size_t count);

}  // namespace ptin::tools
