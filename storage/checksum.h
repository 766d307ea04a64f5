// SPDX-License-Identifier: GPL-3.0-or-later
//
// The one checksum of the format: XXH3, 64 bits, seed 0. Finds damage; no defence against intent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ptin {

[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes) noexcept;

/// Checksum of the bytes of a plain structure.
template <class T>
[[nodiscard]] std::uint64_t checksum_of_object(const T& object) noexcept {
  return checksum_of(std::as_bytes(std::span(&object, 1)));
}

}  // namespace ptin
