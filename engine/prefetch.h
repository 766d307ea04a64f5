// SPDX-License-Identifier: GPL-3.0-or-later
//
// Asking for memory ahead of its use.
#pragma once

namespace ptin {

/// Asks the processor to fetch the cache line at `p`. `p` need not be readable. The empty asm
/// statement counts as an effect: without it gcc 12 drops calls of functions that do nothing but
/// prefetch.
inline void prefetch(const void* p) noexcept {
  __builtin_prefetch(p);
  __asm__ volatile("");
}

}  // namespace ptin
