// SPDX-License-Identifier: GPL-3.0-or-later
//
// Units of memory.
#pragma once

#include <cstdint>

namespace ptin {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

}  // namespace ptin
