// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/memory_plan.h"

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>

#include <gdal.h>

#include "engine/construct/process_limits.h"
#include "engine/number.h"

namespace ptin {

std::uint64_t default_memory() { return std::min(kMemoryOfParts, allowed_memory() / 4 * 3); }

std::uint64_t anonymous_bytes_now() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("RssAnon:", 0) == 0) {
      std::string_view number(line);
      number.remove_prefix(std::min(line.find_first_of("0123456789"), line.size()));
      return take_number<std::uint64_t>(number).value_or(0) * 1024;
    }
  }
  return 0;
}

std::uint64_t MemoryPlan::for_tiles(std::uint64_t present, int threads) const noexcept {
  // The writer's buffers, the manifest's lists, and what the heap keeps between tiles.
  const std::uint64_t other =
      present + gdal_cache + 24 * kMiB + static_cast<std::uint64_t>(threads) * 4 * kMiB;
  return limit > other ? limit - other : 0;
}

MemoryPlan MemoryPlan::within(std::uint64_t other_limit) const noexcept {
  MemoryPlan plan = *this;
  plan.limit = other_limit;
  plan.lines = other_limit / 4;
  plan.gdal_cache = std::clamp(other_limit / 16, 8 * kMiB, 64 * kMiB);
  if (kind == InputKind::kPoints) {
    plan.sorting = std::clamp(other_limit / 8, kMiB, 256 * kMiB);
  } else if (kind == InputKind::kTin) {
    plan.sorting = std::max(other_limit / 2, kMiB);
  }
  return plan;
}

MemoryPlan plan_memory(std::uint64_t asked, InputKind kind) {
  MemoryPlan plan;
  plan.kind = kind;
  plan.allowed = allowed_memory();
  return plan.within(asked != 0 ? asked : default_memory());
}

GdalCacheLimit::GdalCacheLimit(std::uint64_t bytes) : before_(GDALGetCacheMax64()) {
  GDALSetCacheMax64(static_cast<GIntBig>(bytes));
}

GdalCacheLimit::~GdalCacheLimit() { GDALSetCacheMax64(before_); }

}  // namespace ptin
