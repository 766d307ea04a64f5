// SPDX-License-Identifier: GPL-3.0-or-later
//
// Plain values as texts, for messages between processes of the same program.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <string>

#include "engine/construct/scratch/plain_value.h"

namespace ptin {

/// Bytes as two digits each, and back.
[[nodiscard]] std::string digits_of(std::span<const std::byte> bytes);
/// @throws Error invalid_argument  the text is not what digits_of() makes of so many bytes
void take_digits(const std::string& text, std::span<std::byte> bytes);

/// A plain value as a text that another process of the same program takes up.
template <PlainValue T>
[[nodiscard]] std::string text_of_value(const T& value) {
  return digits_of(std::as_bytes(std::span(&value, 1)));
}
/// @throws Error as take_digits()
template <PlainValue T>
[[nodiscard]] T value_in_text(const std::string& text) {
  std::array<std::byte, sizeof(T)> bytes{};
  take_digits(text, bytes);
  return std::bit_cast<T>(bytes);
}

}  // namespace ptin
