// SPDX-License-Identifier: GPL-3.0-or-later
//
// Median, 95th and 99th percentile of measured values.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace ptin::tools {

/// Each is one of the values: the smallest that so many of them do not exceed (nearest rank). A
/// percentile is given where at least two values lie behind it: the 95th of 40 values or more, the
/// 99th of 200 or more. The median is given for any number.
struct Quantiles {
  std::size_t count = 0;
  std::optional<double> median, p95, p99;
};

/// Quantiles of values in any order; no value is NaN.
[[nodiscard]] Quantiles quantiles_of(std::vector<double> values);

}  // namespace ptin::tools
