// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/memory_plan.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <gdal.h>
#include <sys/resource.h>

namespace ptin {

namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The number in a file of one word; no limit where there is none ("max", no such file).
std::uint64_t limit_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? value : kNoLimit;
}

/// The smallest limit of this process's cgroups, of either version of them.
std::uint64_t cgroup_limit() {
  std::uint64_t least = kNoLimit;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (second == std::string::npos) {
      continue;
    }
    const std::string controllers = line.substr(first + 1, second - first - 1);
    std::string path = line.substr(second + 1);
    const bool is_first_version = controllers.find("memory") != std::string::npos;
    if (!controllers.empty() && !is_first_version) {
      continue;
    }
    const std::string root = is_first_version ? "/sys/fs/cgroup/memory" : "/sys/fs/cgroup";
    const std::string name = is_first_version ? "/memory.limit_in_bytes" : "/memory.max";
    while (true) {  // a limit of a group holds for those inside of it
      least = std::min(least, limit_in(root + path + name));
      if (path.empty() || path == "/") {
        break;
      }
      path.resize(path.rfind('/'));
    }
  }
  return least;
}

std::uint64_t resource_limit(int resource) {
  rlimit limit{};
  return ::getrlimit(static_cast<__rlimit_resource>(resource), &limit) == 0 &&
                 limit.rlim_cur != RLIM_INFINITY
             ? static_cast<std::uint64_t>(limit.rlim_cur)
             : kNoLimit;
}

}  // namespace

std::uint64_t allowed_memory() {
  return std::min({cgroup_limit(), resource_limit(RLIMIT_DATA), resource_limit(RLIMIT_AS)});
}

std::uint64_t default_memory() {
  return std::min(std::uint64_t{1024} * kMiB, allowed_memory() / 4 * 3);
}

std::uint64_t anonymous_bytes_now() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("RssAnon:", 0) == 0) {
      return std::stoull(line.substr(8)) * 1024;
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
