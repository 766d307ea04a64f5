// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the system lets this process have: memory and processors.
#pragma once

#include <cstdint>
#include <string>

namespace ptin {

/// Where the kernel shows control groups (cgroups); another place in tests.
struct CgroupPlace {
  std::string groups = "/proc/self/cgroup";  ///< The groups of this process, one a line.
  std::string root = "/sys/fs/cgroup";       ///< Their limits, of either version of them.
};

/// What the smallest of this process's cgroups and resource limits allows, all of it, in bytes; the
/// largest number when none limits it.
[[nodiscard]] std::uint64_t allowed_memory(const CgroupPlace& place = {});

/// How many threads have a processor: those that the affinity of the calling thread names (taskset,
/// cpusets), or as many as the smallest quota of this process's cgroups pays for, rounded up, where
/// that is less. At least 1.
[[nodiscard]] int allowed_threads(const CgroupPlace& place = {});

}  // namespace ptin
