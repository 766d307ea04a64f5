// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory there is for a build, and how it is shared out.
#pragma once

#include <cstdint>

namespace ptin {

inline constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// What the smallest of this process's cgroups and resource limits allows, all of it; the largest
/// number when none limits it.
[[nodiscard]] std::uint64_t allowed_memory();

/// Memory that this process may take without being asked: 1 GiB, or three quarters of what its
/// cgroup or resource limits allow where that is less.
[[nodiscard]] std::uint64_t default_memory();

/// Anonymous memory of this process now, bytes; 0 where the system does not tell.
[[nodiscard]] std::uint64_t anonymous_bytes_now();

/// The shares of a limit on anonymous memory.
struct MemoryShares {
  std::uint64_t gdal_cache = 0;  ///< Decoded blocks of rasters.
  std::uint64_t tiles = 0;       ///< Tiles in work; 0 when nothing is left for them.
};

/// @param memory   The limit.
/// @param present  What the process holds already.
/// @param threads  Each needs a little of its own.
[[nodiscard]] MemoryShares share_memory(std::uint64_t memory, std::uint64_t present, int threads);

/// Sets the size of GDAL's block cache, which all of the process shares, for as long as this lives.
class GdalCacheLimit {
 public:
  explicit GdalCacheLimit(std::uint64_t bytes);
  ~GdalCacheLimit();
  GdalCacheLimit(const GdalCacheLimit&) = delete;
  GdalCacheLimit& operator=(const GdalCacheLimit&) = delete;

 private:
  std::int64_t before_;
};

}  // namespace ptin
