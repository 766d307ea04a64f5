// SPDX-License-Identifier: GPL-3.0-or-later
//
// The limits that every question is asked with.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stop_token>

#include "engine/memory_units.h"

namespace ptin {

/// How much a question may take, and how it is stopped.
struct QueryLimits {
  /// Most bytes that the question may hold: records, mesh and results. Records and mesh are known
  /// from the index before a page is read, results as they grow; a question that needs more is
  /// refused (resource_exhausted).
  std::uint64_t memory_bytes = kMemoryOfQuestion;
  std::stop_token stop{};  ///< Looked at in every long loop.

  /// The limits of a part of the question: `part` of `parts` equal shares of the memory, and `most`
  /// bytes of it where that is less.
  [[nodiscard]] QueryLimits share(std::uint64_t part, std::uint64_t parts,
                                  std::uint64_t most = UINT64_MAX) const {
    return {std::min(memory_bytes / parts * part, most), stop};
  }
};

}  // namespace ptin
