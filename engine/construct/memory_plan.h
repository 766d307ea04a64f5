// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much memory there is for a build, and how it is shared out.
#pragma once

#include <cstdint>

#include "engine/construct/read/input_kind.h"
#include "engine/memory_units.h"

namespace ptin {

/// Memory that this process may take without being asked: 1 GiB, or three quarters of what its
/// cgroup or resource limits allow where that is less.
[[nodiscard]] std::uint64_t default_memory();

/// Anonymous memory of this process now, bytes; 0 where the system does not say.
[[nodiscard]] std::uint64_t anonymous_bytes_now();

/// How the memory of one build is shared out. Made once, before anything is read, and handed down.
struct MemoryPlan {
  InputKind kind = InputKind::kRaster;  ///< The source that it is made for.
  std::uint64_t limit = 0;              ///< Most anonymous memory of the process, bytes.
  std::uint64_t allowed = 0;            ///< By cgroups and resource limits; may be less.
  std::uint64_t gdal_cache = 0;         ///< Decoded blocks of rasters.
  std::uint64_t lines = 0;              ///< Breaklines and boundary, from reading to the end.
  std::uint64_t sorting = 0;            ///< Points, or a TIN, on their way into temporary files.

  /// What is left for tiles in work; 0 when nothing is.
  /// @param present  What the process holds already, bytes.
  /// @param threads  Each needs a little of its own.
  [[nodiscard]] std::uint64_t for_tiles(std::uint64_t present, int threads) const noexcept;
  /// The plan of the same source within another limit.
  [[nodiscard]] MemoryPlan within(std::uint64_t other_limit) const noexcept;
};

/// @param asked  The limit that the caller sets; 0: default_memory().
/// @param kind   Kind of the source: points and TINs are sorted before tiles are begun.
[[nodiscard]] MemoryPlan plan_memory(std::uint64_t asked, InputKind kind);

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
