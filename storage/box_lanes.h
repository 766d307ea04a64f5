// SPDX-License-Identifier: GPL-3.0-or-later
//
// Four 32-bit numbers at once, by the vector types that gcc and clang share. A record is made of
// such quadruples (its roi; its heights, error and deviation), and is decoded and checked three
// times faster by them than field by field.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace ptin::lanes {

using Int4 = std::int32_t __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));
using Unsigned4 = std::uint32_t __attribute__((vector_size(16)));
using Unsigned2 = std::uint64_t __attribute__((vector_size(16)));
using Short4 = std::int16_t __attribute__((vector_size(8)));

template <class Lanes>
[[nodiscard]] inline Lanes load(const void* from) noexcept {
  Lanes v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class Lanes>
inline void store(void* to, const Lanes& v) noexcept {
  std::memcpy(to, &v, sizeof v);
}

/// Lanes 0 1 and 2 3, given by 64 bits each.
[[nodiscard]] inline Int4 pair(std::uint64_t lower, std::uint64_t upper) noexcept {
  return std::bit_cast<Int4>(Unsigned2{lower, upper});
}
/// Sums that wrap around.
[[nodiscard]] inline Int4 sum(Int4 a, Int4 b) noexcept {
  return std::bit_cast<Int4>(std::bit_cast<Unsigned4>(a) + std::bit_cast<Unsigned4>(b));
}
/// `a`, moved down by `by` in the lanes of which `down` has all bits, in the others up; wraps around.
[[nodiscard]] inline Int4 moved(Int4 a, Int4 by, Int4 down) noexcept {
  return std::bit_cast<Int4>(std::bit_cast<Unsigned4>(a) + (std::bit_cast<Unsigned4>(by ^ down) -
                                                            std::bit_cast<Unsigned4>(down)));
}
/// The numbers whose lower `width` bits are those of the lanes, in two's complement.
[[nodiscard]] inline Int4 with_sign(Int4 bits, unsigned width) noexcept {
  const int above = 32 - static_cast<int>(width);
  return std::bit_cast<Int4>(std::bit_cast<Unsigned4>(bits) << above) >> above;
}
/// Of the result of a comparison of points: where it holds for both coordinates of one.
[[nodiscard]] inline Int4 both(Int4 v) noexcept {
  return v & __builtin_shufflevector(v, v, 1, 0, 3, 2);
}

/// True when any bit of `v` is set. For the result of a comparison: true when it holds for any
/// lane.
[[nodiscard]] inline bool any(Int4 v) noexcept {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(v);
  return (halves[0] | halves[1]) != 0;
}

/// The lower half of `v` twice, lanes 0 1 0 1, and the upper half twice, lanes 2 3 2 3.
[[nodiscard]] inline Int4 lower_twice(Int4 v) noexcept {
  return __builtin_shufflevector(v, v, 0, 1, 0, 1);
}
[[nodiscard]] inline Int4 upper_twice(Int4 v) noexcept {
  return __builtin_shufflevector(v, v, 2, 3, 2, 3);
}

}  // namespace ptin::lanes
