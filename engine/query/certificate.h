// SPDX-License-Identifier: GPL-3.0-or-later
//
// Certificates: what the records that were left out can be off by, from the file's table of errors
// (DESIGN.md, section 2).
#pragma once

#include <span>

#include "engine/query/retrieval.h"
#include "storage/store_file.h"

namespace ptin {

/// Bounds of an answer, in the height's unit; at least those of the file's finest TIN against its
/// source.
struct Certificate {
  double error = 0.0;      ///< At every input sample.
  double deviation = 0.0;  ///< At any point.
  bool complete = true;    ///< No record was left out.
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
