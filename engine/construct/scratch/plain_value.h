// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values whose bytes may be written as they are.
#pragma once

#include <array>
#include <bit>
#include <type_traits>

namespace ptin {

namespace plain_value_internal {

/// Reads every byte of a T, which is no constant expression where one of them is padding: what stood
/// there is lost on the way through a T.
template <class T>
consteval bool reads_all_bytes() {
  using Bytes = std::array<unsigned char, sizeof(T)>;
  unsigned sum = 0;
  for (const unsigned char byte : std::bit_cast<Bytes>(std::bit_cast<T>(Bytes{}))) {
    sum += byte;
  }
  return sum == 0;
}

}  // namespace plain_value_internal

/// A value that is the same bytes wherever it is made. Padding between members would hold whatever
/// was in memory before, so work that is done again would be written otherwise, and its checksum
/// would be another one. std::has_unique_object_representations does not do: no float has it.
template <class T>
concept PlainValue = std::is_trivially_copyable_v<T> && requires {
  typename std::bool_constant<plain_value_internal::reads_all_bytes<T>()>;
};

}  // namespace ptin
