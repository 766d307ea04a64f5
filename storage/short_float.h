// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors, deviations and deaths in 16 bits: the upper half of a float, rounded up (the format that
// is known as bfloat16). Eight bits of precision change a bound by less than 0.8 %, never downward,
// and leave whole numbers up to 256 as they are. Rounding up keeps order, and so saturation; every
// copy of an error (record, star, index, table) is the rounded one.
#pragma once

#include <bit>
#include <cstdint>

#include "storage/layout.h"

namespace ptin {

/// Bits of a number that is not negative, finite or +infinity.
using ShortBits = std::uint16_t;
inline constexpr ShortBits kShortInfinity = layout::kInfinityBits >> 16;

/// The bits of the least short number that is not below `v`. REQUIRES: v >= 0.
[[nodiscard]] constexpr ShortBits short_bits(float v) noexcept {
  return static_cast<ShortBits>((layout::to_bits(v) + 0xFFFFU) >> 16);
}
[[nodiscard]] constexpr float short_value(ShortBits bits) noexcept {
  return layout::to_float(std::uint32_t{bits} << 16);
}
/// The least short number that is not below `v`. REQUIRES: v >= 0.
[[nodiscard]] constexpr float shortened(float v) noexcept { return short_value(short_bits(v)); }

/// A death in 16 bits: 0 for a triangle that lives on, else the bits of the error plus 1.
/// REQUIRES: kLivesOn, or an error.
[[nodiscard]] constexpr ShortBits death_bits(float death) noexcept {
  return death < 0.0F ? ShortBits{0} : static_cast<ShortBits>(short_bits(death) + 1);
}
inline constexpr ShortBits kMostDeathBits = kShortInfinity + 1;

}  // namespace ptin
