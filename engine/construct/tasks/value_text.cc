// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/tasks/value_text.h"

#include <charconv>

#include "engine/error.h"

namespace ptin {

std::string digits_of(std::span<const std::byte> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::byte b : bytes) {
    text += kDigits[std::to_integer<unsigned>(b) >> 4U];
    text += kDigits[std::to_integer<unsigned>(b) & 15U];
  }
  return text;
}

void take_digits(const std::string& text, std::span<std::byte> bytes) {
  bool is_one = text.size() == 2 * bytes.size();
  for (std::size_t i = 0; is_one && i < bytes.size(); ++i) {
    unsigned value = 0;
    const char* const end = text.data() + 2 * i + 2;
    is_one = std::from_chars(end - 2, end, value, 16).ptr == end;
    bytes[i] = static_cast<std::byte>(value);
  }
  if (!is_one) {
    throw Error(ErrorCode::invalid_argument,
                "what another process of the build tells is not what this program expects; let all "
                "of them run the same program");
  }
}

}  // namespace ptin
