// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a file's table of errors tells: quantiles, and how many vertices a tolerance takes.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/store_file.h"

namespace ptin::tools {

/// Vertices of T0 and records with error above `tolerance`; records of the bin that holds the
/// tolerance are counted, so this is at most an eighth of an octave of them too many.
[[nodiscard]] std::uint64_t vertices_at(const StoreFile& store, double tolerance);

/// The error below which (or at which) `share` of the records lie: the upper end of its bin; may be
/// +infinity.
[[nodiscard]] double error_quantile(const StoreFile& store, double share);

/// The largest finite upper end of a bin with records; 0 when there is none.
[[nodiscard]] double largest_finite_error(const StoreFile& store);

/// Tolerances 1, 2, 5 times powers of ten that make a difference to this file, ascending; at most
/// `count`, the largest kept.
[[nodiscard]] std::vector<double> round_tolerances(const StoreFile& store, std::size_t count);

}  // namespace ptin::tools
