// SPDX-License-Identifier: GPL-3.0-or-later
//
// A window of a raster.
#pragma once

#include <cstdint>

namespace ptin {

/// A window of samples: columns x0 to x0 + width - 1 from the west, rows y0 to y0 + height - 1 from
/// the south.
struct SampleRange {
  std::int64_t x0 = 0, y0 = 0, width = 0, height = 0;
  [[nodiscard]] std::uint64_t samples() const noexcept {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

}  // namespace ptin
