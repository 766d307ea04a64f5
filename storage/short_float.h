// SPDX-License-Identifier: GPL-3.0-or-later
//
// Errors, deviations and deaths in 16 bits: the upper half of a float, rounded up (the format that
// is known as bfloat16). Eight bits of precision change a bound by less than 0.8 %, never downward,
// and leave whole numbers up to 256 as they are. Rounding up keeps order, and so saturation; every
// copy of an error (record, star, index, table) is the rounded one.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

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

/// A level of detail among the bits of short numbers: an error is above the level when its bits are
/// greater, and a death_bits() is at or below it when it is at most one more. -1: a level below 0.
[[nodiscard]] constexpr std::int32_t level_bits(double level) noexcept {
  if (!(level >= 0.0)) {
    return -1;
  }
  const auto up = shortened(level < static_cast<double>(std::numeric_limits<float>::max())
                                ? static_cast<float>(level)
                                : std::numeric_limits<float>::infinity());
  return short_bits(up) - (static_cast<double>(up) > level ? 1 : 0);
}

/// A death in 16 bits, as descriptors and T0 have it: 0 for a triangle that lives on, else the bits of the error plus 1.
/// REQUIRES: kLivesOn, or an error.
[[nodiscard]] constexpr ShortBits death_bits(float death) noexcept {
  return death < 0.0F ? ShortBits{0} : static_cast<ShortBits>(short_bits(death) + 1);
}
inline constexpr ShortBits kMostDeathBits = kShortInfinity + 1;

// Zero and infinity lie far from the other numbers of a page, so a column holds them beside its
// base: 0 is zero, 1 is infinity, and n > 1 is the short number of bits base + n - 2.
inline constexpr std::uint32_t kFirstAboveBase = 2;
[[nodiscard]] constexpr bool is_beside_base(ShortBits bits) noexcept {
  return bits == 0 || bits == kShortInfinity;
}
/// REQUIRES: bits is beside the base, or not below it.
[[nodiscard]] constexpr std::uint32_t stored_short(ShortBits bits, ShortBits base) noexcept {
  return is_beside_base(bits) ? (bits == 0 ? 0U : 1U)
                              : bits - std::uint32_t{base} + kFirstAboveBase;
}
/// The bits of a short number, or more than kShortInfinity where none is stored so.
[[nodiscard]] constexpr std::uint32_t short_of_stored(std::uint64_t stored,
                                                      ShortBits base) noexcept {
  return stored < kFirstAboveBase ? (stored == 0 ? 0U : std::uint32_t{kShortInfinity})
                                  : static_cast<std::uint32_t>(base + stored - kFirstAboveBase);
}

/// A death beside the error of the star's record: 0 for a triangle that lives on, 1 for a death at
/// error 0, else how many short numbers it is below the error, plus 2.
/// REQUIRES: death <= error, both short.
[[nodiscard]] constexpr std::uint32_t stored_death(float death, ShortBits error) noexcept {
  const ShortBits bits = death < 0.0F ? ShortBits{0} : short_bits(death);
  return bits == 0 ? (death < 0.0F ? 0U : 1U) : std::uint32_t{error} - bits + kFirstAboveBase;
}

}  // namespace ptin
