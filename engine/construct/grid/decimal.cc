// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/grid/decimal.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "engine/check.h"

namespace ptin {
namespace {

constexpr int kMostDigits = 18;  // 10^18 - 1 fits in 63 bits
constexpr std::int64_t kFirstTooLarge = power_of_ten(kMostDigits);

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Digits gathered into a mantissa; those beyond the 18th are rounded away, half away from zero.
struct Digits {
  std::int64_t mantissa = 0;
  int count = 0;     ///< Significant digits in the mantissa.
  int decimals = 0;  ///< Digits of the mantissa behind the point.
  int dropped = 0;   ///< Digits before the point that found no room.
  int first_dropped = -1;
  bool any = false;

  void add(char c, bool behind_point) {
    any = true;
    if (count < kMostDigits) {
      mantissa = mantissa * 10 + (c - '0');
      count += mantissa != 0 ? 1 : 0;
      decimals += behind_point ? 1 : 0;
      return;
    }
    first_dropped = first_dropped < 0 ? c - '0' : first_dropped;
    dropped += behind_point ? 0 : 1;
  }
};

/// Reads an exponent into `exponent`, clamped far beyond what any number here can have. False when
/// `text` is no whole number.
bool parse_exponent(std::string_view text, int& exponent) {
  bool negative = false;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    negative = text[0] == '-';
    text.remove_prefix(1);
  }
  if (text.empty() || !std::all_of(text.begin(), text.end(), is_digit)) {
    return false;
  }
  int value = 0;
  for (const char c : text) {
    value = std::min(value * 10 + (c - '0'), 100000);
  }
  exponent = negative ? -value : value;
  return true;
}

/// Brings mantissa / 10^decimals to 0 <= decimals <= 18 without trailing zeros behind the point.
/// False when it is 10^18 or more.
bool normalise(std::int64_t& mantissa, std::int64_t& decimals) {
  for (; decimals < 0 && mantissa != 0; ++decimals) {
    if (mantissa >= kFirstTooLarge / 10) {
      return false;
    }
    mantissa *= 10;
  }
  for (; decimals > kMostDigits && mantissa != 0; --decimals) {
    mantissa = mantissa / 10 + (decimals == kMostDigits + 1 && mantissa % 10 >= 5 ? 1 : 0);
  }
  for (; decimals > 0 && mantissa % 10 == 0 && mantissa != 0; --decimals) {
    mantissa /= 10;
  }
  decimals = mantissa == 0 ? 0 : decimals;
  return mantissa < kFirstTooLarge;  // rounding may have made it 10^18
}

/// True when `text` is `word`, in any case.
/// @param word  In lower case.
bool is_word(std::string_view text, std::string_view word) {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(), [](char c, char lower) {
    return (c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) == lower;
  });
}

NumberKind parse_word(std::string_view text) {
  if (is_word(text, "nan")) {
    return NumberKind::kNotANumber;
  }
  return is_word(text, "inf") || is_word(text, "infinity") ? NumberKind::kInfinite
                                                           : NumberKind::kNoNumber;
}

}  // namespace

double to_double(Decimal d) noexcept {
  static constexpr std::array<double, 19> kPowers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,
                                                     1e7,  1e8,  1e9,  1e10, 1e11, 1e12, 1e13,
                                                     1e14, 1e15, 1e16, 1e17, 1e18};
  return static_cast<double>(d.mantissa) / kPowers[static_cast<std::size_t>(d.decimals)];
}

NumberKind parse_number(std::string_view text, Decimal& value) noexcept {
  bool negative = false;
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) {
    negative = text[i++] == '-';
  }
  Digits digits;
  bool behind_point = false;
  for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !behind_point)); ++i) {
    if (text[i] == '.') {
      behind_point = true;
    } else {
      digits.add(text[i], behind_point);
    }
  }
  if (!digits.any) {
    return parse_word(text.substr(std::min(i, text.size())));
  }
  int exponent = 0;
  if (i < text.size()) {
    const bool has_exponent = text[i] == 'e' || text[i] == 'E';
    if (!has_exponent || !parse_exponent(text.substr(i + 1), exponent)) {
      return NumberKind::kNoNumber;
    }
  }
  std::int64_t mantissa = digits.mantissa + (digits.first_dropped >= 5 ? 1 : 0);
  std::int64_t decimals = std::int64_t{digits.decimals} - digits.dropped - exponent;
  if (!normalise(mantissa, decimals)) {
    return NumberKind::kTooLarge;
  }
  value = {negative ? -mantissa : mantissa, static_cast<std::int32_t>(decimals)};
  return NumberKind::kNumber;
}

Decimal decimal_of(double value) {
  std::array<char, 64> text{};
  const auto [end, status] = std::to_chars(text.data(), text.data() + text.size(), value);
  Decimal decimal;
  const NumberKind kind =
      parse_number({text.data(), static_cast<std::size_t>(end - text.data())}, decimal);
  PTIN_CHECK(status == std::errc() && kind == NumberKind::kNumber);
  return decimal;
}

}  // namespace ptin
