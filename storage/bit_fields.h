// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers of any width up to 57 bits, one behind the other without gaps, the lowest bit first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ptin {

/// The widest number that one load of eight bytes always holds.
inline constexpr unsigned kMostFieldBits = 57;

/// The number of `width` bits at bit `at`. REQUIRES: width <= 57; `from` is readable up to eight
/// bytes from the byte that holds bit `at`.
[[nodiscard]] inline std::uint64_t read_bits(const std::byte* from, std::size_t at,
                                             unsigned width) noexcept {
  std::uint64_t word;
  std::memcpy(&word, from + at / 8, sizeof word);
  return (word >> (at % 8)) & ((std::uint64_t{1} << width) - 1);
}

/// The number whose lower `width` bits are these, in two's complement.
[[nodiscard]] constexpr std::int64_t with_sign(std::uint64_t bits, unsigned width) noexcept {
  const std::uint64_t sign = (std::uint64_t{1} << width) >> 1;
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

/// Writes the lower `width` bits of a number. REQUIRES: width <= 57; the bits from `at` on are
/// zero; `to` is writable up to eight bytes from the byte that holds bit `at`.
inline void write_bits(std::byte* to, std::size_t at, unsigned width,
                       std::uint64_t value) noexcept {
  std::uint64_t word;
  std::memcpy(&word, to + at / 8, sizeof word);
  word |= (value & ((std::uint64_t{1} << width) - 1)) << (at % 8);
  std::memcpy(to + at / 8, &word, sizeof word);
}

}  // namespace ptin
