// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers in texts, whatever the locale.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
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

/// Which numbers mean something.
struct NumberRange {
  static const NumberRange kFinite, kNotNegative, kPositive;
  static const NumberRange kTolerance;  ///< No less than 0; infinite is as coarse as it can be.
  static const NumberRange kAny;        ///< Infinities and NaN, too.

  double least = std::numeric_limits<double>::lowest();
  double most = std::numeric_limits<double>::max();
  bool is_above = false;  ///< `least` is none itself.
  bool has_nan = false;

  [[nodiscard]] bool holds(double number) const noexcept {
    if (std::isnan(number)) return has_nan;
    return (is_above ? number > least : number >= least) && number <= most;
  }
};
inline constexpr NumberRange NumberRange::kFinite{};
inline constexpr NumberRange NumberRange::kNotNegative{.least = 0};
inline constexpr NumberRange NumberRange::kPositive{.least = 0, .is_above = true};
inline constexpr NumberRange NumberRange::kTolerance{
    .least = 0, .most = std::numeric_limits<double>::infinity()};
inline constexpr NumberRange NumberRange::kAny{.least = -std::numeric_limits<double>::infinity(),
                                               .most = std::numeric_limits<double>::infinity(),
                                               .has_nan = true};

/// "a finite number > 0", "a whole number from 1 to 9": what a refusal says was expected.
[[nodiscard]] inline std::string words_of(const NumberRange& range, bool is_whole = false) {
  const auto text = [](double number) {
    std::array<char, 400> digits{};  // As many as the largest one has.
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number,
                                   std::chars_format::fixed);
    return std::string(digits.data(), end.ptr);
  };
  const bool has_least = range.least > NumberRange::kFinite.least || is_whole;
  const bool has_most = range.most < NumberRange::kFinite.most;
  const bool is_finite = std::isfinite(range.most) && !has_most;
  std::string words = is_whole ? "a whole number" : is_finite ? "a finite number" : "a number";
  if (!has_least) return words;
  const std::string least = text(is_whole ? std::max(0.0, range.least) : range.least);
  if (has_most) return words + " from " + least + " to " + text(range.most);
  return words + (range.is_above ? " > " : " >= ") + least;
}

}  // namespace ptin
