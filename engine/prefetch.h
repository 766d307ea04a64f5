// SPDX-License-Identifier: GPL-3.0-or-later
//
// Asking for memory ahead of its use.
#pragma once

namespace ptin {

/// Asks the processor to fetch the cache line at `p`, which need not be readable.
/// The empty statement keeps gcc from taking a function that does nothing else for one without
/// effects, and dropping its calls (gcc 12 does).
inline void prefetch(const void* p) noexcept {
  __builtin_prefetch(p);
  __asm__ volatile("");
}

}  // namespace ptin
