// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers in the bytes of LAS and LAZ files.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

namespace ptin {

/// Reads a little-endian value that begins at byte `at`. REQUIRES: it lies inside of `bytes`.
template <class T>
[[nodiscard]] T las_value(std::span<const unsigned char> bytes, std::size_t at) noexcept {
  static_assert(std::endian::native == std::endian::little && std::is_trivially_copyable_v<T>);
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace ptin
