// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers in texts, whatever the locale.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace ptin {

/// Takes the number that a text begins with off it, as C++ writes numbers: digits, for other types
/// than integers with a point and an exponent too, and for signed ones with a sign before them. NaN and
/// infinities are numbers: "nan", "inf". A floating one that is too large is infinite, and one too near
/// to 0 is 0. None where the text begins otherwise, with blanks too, or a whole one does not fit into T.
template <class T>
[[nodiscard]] std::optional<T> take_number(std::string_view& text) noexcept {
  static_assert(std::is_arithmetic_v<T>);
  std::string_view number = text;
  // std::from_chars takes "-" alone; people and other programs write "+" too.
  if (number.starts_with('+') && !number.starts_with("+-")) {
    number.remove_prefix(1);
  }
  T value{};
  const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), value);
  if constexpr (std::is_floating_point_v<T>) {
    if (fault == std::errc::result_out_of_range) {
      // A wider type still shows which of both it is; where even that is too narrow, the exponent
      // does, or the digits before the point.
      number = number.substr(0, static_cast<std::size_t>(end - number.data()));
      constexpr auto kTooLarge = std::numeric_limits<long double>::infinity();
      const std::size_t exponent = number.find_first_of("eE");
      const bool is_tiny =
          exponent == std::string_view::npos
              ? number.substr(0, number.find('.')).find_first_not_of("-0") == std::string_view::npos
              : number[exponent + 1] == '-';
      long double wide = is_tiny ? 0.0L : number.starts_with('-') ? -kTooLarge : kTooLarge;
      std::from_chars(number.data(), end, wide);
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
      return static_cast<T>(wide);
    }
  }
  if (fault != std::errc()) {
    return std::nullopt;
  }
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// The number that a whole text is, as take_number() has them; none where anything stands behind it.
template <class T>
[[nodiscard]] std::optional<T> parse_number(std::string_view text) noexcept {
  const std::optional<T> number = take_number<T>(text);
  return text.empty() ? number : std::nullopt;
}

/// Which numbers are meant.
enum class NumberRange : std::uint8_t {
  kFinite,
  kNotNegative,  ///< Finite, no less than 0.
  kPositive,     ///< Finite, above 0.
  kTolerance,    ///< No less than 0; infinite is as coarse as it can be.
};

[[nodiscard]] inline bool is_in(NumberRange range, double number) noexcept {
  switch (range) {
    case NumberRange::kNotNegative:
      return std::isfinite(number) && number >= 0;
    case NumberRange::kPositive:
      return std::isfinite(number) && number > 0;
    case NumberRange::kTolerance:
      return number >= 0;
    case NumberRange::kFinite:
      break;
  }
  return std::isfinite(number);
}

/// "a finite number > 0": what a refusal says was expected.
[[nodiscard]] inline const char* words_of(NumberRange range) noexcept {
  constexpr const char* kWords[] = {"a finite number", "a finite number >= 0",
                                    "a finite number > 0", "a number >= 0"};
  return kWords[static_cast<std::size_t>(range)];
}

}  // namespace ptin
