// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/measure/quantiles.h"

#include <algorithm>

namespace ptin::tools {

Quantiles quantiles_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  // In hundredths, so that no rounding moves a rank.
  const auto rank_of = [n](std::size_t percent) { return (n * percent + 99) / 100; };
  const auto with_two_behind = [&](std::size_t percent) -> std::optional<double> {
    const std::size_t rank = rank_of(percent);
    if (n < rank + 2) return {};
    return values[rank - 1];
  };
  Quantiles quantiles;
  quantiles.count = n;
  if (n > 0) {
    quantiles.median = values[rank_of(50) - 1];
    quantiles.p95 = with_two_behind(95);
    quantiles.p99 = with_two_behind(99);
  }
  return quantiles;
}

}  // namespace ptin::tools
