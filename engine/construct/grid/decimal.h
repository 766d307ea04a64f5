// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers as sources write them: in decimals, so that no digit of a coordinate is lost on the way
// to the grid.
#pragma once

#include <cstdint>
#include <string_view>

namespace ptin {

/// The number mantissa / 10^decimals. A Decimal that parse_number() or decimal_of() makes has no
/// trailing zeros after the point; others may have.
struct Decimal {
  std::int64_t mantissa = 0;  ///< At most 18 digits: further digits are rounded away.
  std::int32_t decimals = 0;  ///< 0 .. 18
  friend bool operator==(const Decimal&, const Decimal&) = default;
};

/// 10^exponent; 1 where `exponent` is negative. REQUIRES: exponent <= 18.
[[nodiscard]] constexpr std::int64_t power_of_ten(int exponent) noexcept {
  std::int64_t power = 1;
  for (; exponent > 0; --exponent) {
    power *= 10;
  }
  return power;
}

/// The double nearest to `d` where the mantissa is at most 2^53. A larger mantissa is rounded to a
/// double first.
[[nodiscard]] double to_double(Decimal d) noexcept;

/// What a piece of text is, in the order of the enumerators: a number that a Decimal holds, "nan",
/// an infinity, a number that is too large for a Decimal, or no number at all.
enum class NumberKind : std::uint8_t { kNumber, kNotANumber, kInfinite, kTooLarge, kNoNumber };

/// Reads all of `text` as a number: sign, digits, decimal point, exponent; or as one of the words
/// "nan", "inf" and "infinity", in any case. Digits beyond the 18th are rounded away.
/// @param value  Receives the number where kNumber is returned, else stays as it is.
/// @return  kTooLarge where the rounded number is 10^18 or more, or -10^18 or less.
[[nodiscard]] NumberKind parse_number(std::string_view text, Decimal& value) noexcept;

/// The shortest decimal that reads back as `value`. Where that has more than 18 digits after the
/// point it is rounded to 18.
/// REQUIRES: `value` is finite, and |value| < 10^18. Cost: about 0.1 us.
[[nodiscard]] Decimal decimal_of(double value);

}  // namespace ptin
