// SPDX-License-Identifier: GPL-3.0-or-later
//
// The order in which a best-first search takes what it finds.
#pragma once

#include <cstdint>

#include "engine/geometry/infinity.h"

namespace ptin {

/// How good what is looked for is in a best-first search: by its value, larger is better, and among equal
/// values by its place, smaller is better.
struct Merit {
  double value;  ///< Not NaN.
  std::uint64_t place = 0;
  [[nodiscard]] bool is_below(const Merit& other) const noexcept {
    return value != other.value ? value < other.value : place > other.place;
  }
};
/// Below the merit of everything, and that of what is not wanted.
inline constexpr Merit kNoMerit{-kInfinity, ~std::uint64_t{0}};
/// Above the merit of everything: as a cut-off it ends a search.
inline constexpr Merit kBestMerit{kInfinity, 0};

}  // namespace ptin
