// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/freed_memory.h"

#include <algorithm>
#include <cstdint>

#include <malloc.h>

namespace ptin::tools {

void return_freed_memory(int threads) {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
  mallopt(M_ARENA_MAX, threads + 1);
}

void keep_freed_memory(const BuildPlan& plan) {
  constexpr std::uint64_t kLeast = std::uint64_t{64} << 20, kMost = std::uint64_t{256} << 20;
  const std::uint64_t room = plan.memory.limit - std::min(plan.memory.limit, plan.memory_expected);
  const std::uint64_t kept = std::min(room / static_cast<std::uint64_t>(plan.threads + 1), kMost);
  if (kept >= kLeast) {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that malloc takes
    // Half of it at the end of a thread's memory; as much may be kept between blocks in use.
    mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept / 2));
  } else {
    return_freed_memory(plan.threads);
  }
}

void give_back_freed_memory() { malloc_trim(0); }

}  // namespace ptin::tools
