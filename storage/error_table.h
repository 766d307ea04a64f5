// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table of errors: how many records fall into each eighth of an octave of error, and their
// largest deviation.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "storage/record.h"
#include "storage/store_file.h"

namespace ptin {

/// The upper end of the bin that holds `error`: 0 for 0, +infinity for +infinity, otherwise the
/// least float not below `error` whose lower 20 mantissa bits are zero. An octave has eight such
/// floats.
/// REQUIRES: error >= 0.
[[nodiscard]] float error_bin_upper(float error) noexcept;

/// How many records some bins have.
[[nodiscard]] std::uint64_t records_in(const std::vector<ErrorBin>& bins) noexcept;

/// Counts records into bins. Memory: one bin for each that is not empty, at most 2041.
class ErrorTable {
 public:
  void add(const VertexSplit& r);
  /// Adds a bin of another table.
  void add(const ErrorBin& bin);
  /// Bins that are not empty, and the one of error 0 in any case, ascending.
  [[nodiscard]] std::vector<ErrorBin> bins() const;

 private:
  std::map<std::uint32_t, ErrorBin> bins_;  // by the bits of `upper`, which ascend with it
};

}  // namespace ptin
