// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/measure/lanes.h"

#include <algorithm>
#include <atomic>

namespace ptin {
namespace {

std::atomic<LaneSet>& in_use() noexcept {
  static std::atomic<LaneSet> set{lanes_of_processor()};
  return set;
}

}  // namespace

LaneSet lanes_of_processor() noexcept {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") != 0) {
    return LaneSet::kAvx512;
  }
  if (__builtin_cpu_supports("avx2") != 0) {
    return LaneSet::kAvx2;
  }
#endif
  return LaneSet::kPlain;
}

void use_lanes(LaneSet most) noexcept { in_use() = std::min(most, lanes_of_processor()); }
LaneSet lanes_in_use() noexcept { return in_use().load(std::memory_order_relaxed); }

}  // namespace ptin
