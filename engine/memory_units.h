// SPDX-License-Identifier: GPL-3.0-or-later
//
// Units of memory.
#pragma once

#include <cstdint>

namespace ptin {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

/// What a question may take where nobody says.
inline constexpr std::uint64_t kMemoryOfQuestion = 4 * kGiB;
/// What work that reads a source, or goes through a terrain in parts, may take where nobody says.
inline constexpr std::uint64_t kMemoryOfParts = kGiB;

}  // namespace ptin
