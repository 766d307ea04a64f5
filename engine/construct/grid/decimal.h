// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers as sources write them: in decimals, so that no digit of a coordinate is lost on the way
// to the grid.
#pragma once

#include <cstdint>
#include <string_view>

namespace ptin {

/// A number as it is written in decimals: mantissa / 10^decimals. Text gives no trailing zeros
/// after the point.
struct Decimal {
  std::int64_t mantissa = 0;  ///< At most 18 digits: further ones are rounded away.
  std::int32_t decimals = 0;  ///< 0 .. 18
  friend bool operator==(const Decimal&, const Decimal&) = default;
};

/// REQUIRES: exponent <= 18.
[[nodiscard]] constexpr std::int64_t power_of_ten(int exponent) noexcept {
  std::int64_t power = 1;
  for (; exponent > 0; --exponent) {
    power *= 10;
  }
  return power;
}

/// The double nearest to a decimal, but for one rounding more where its mantissa exceeds 2^53.
[[nodiscard]] double to_double(Decimal d) noexcept;

/// What a piece of text is.
enum class NumberKind : std::uint8_t { kNumber, kNotANumber, kInfinite, kTooLarge, kNoNumber };

/// Reads all of `text` as a number: sign, digits, decimal point, exponent; or "nan", "inf".
/// kTooLarge for what is 10^18 or more when it is rounded to 18 digits. `value` is set for kNumber
/// alone.
[[nodiscard]] NumberKind parse_number(std::string_view text, Decimal& value) noexcept;

/// The shortest decimal that reads back as `value`; of magnitudes below 10^-18, 0.
/// REQUIRES: finite, |value| < 10^18. Cost: about 0.1 us.
[[nodiscard]] Decimal decimal_of(double value);

}  // namespace ptin
