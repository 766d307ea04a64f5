// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page cache under our feet: dropping a file from it, looking what of it is there, and what a
// step made the system read.
#pragma once

#include <cstdint>
#include <string>

namespace ptin::bench {

/// Drops the file's pages from the cache (sync, then posix_fadvise DONTNEED, a few times) and
/// returns the bytes that are resident all the same, by mincore; 0 is cold. Mapped pages stay:
/// close every store on it before.
/// @throws std::system_error
std::uint64_t drop_from_cache(const std::string& path);

/// Bytes of the file that are in the page cache.  @throws std::system_error
[[nodiscard]] std::uint64_t resident_bytes(const std::string& path);

/// What this process had the system do so far.
struct SystemReads {
  std::uint64_t device_bytes =
      0;  ///< read_bytes of /proc/self/io: asked of the block layer, read-ahead included.
  std::uint64_t major_faults = 0;  ///< Faults that waited for the device.
  std::uint64_t minor_faults = 0;

  [[nodiscard]] static SystemReads now();
  [[nodiscard]] SystemReads since(const SystemReads& before) const {
    return {device_bytes - before.device_bytes, major_faults - before.major_faults,
            minor_faults - before.minor_faults};
  }
};

/// What the device under a file gives, read around the page cache (O_DIRECT).
struct DeviceSpeed {
  double sequential_mb_s =
      0;  ///< Best of several passes of 8 readers, 1 MiB blocks, over at most 512 MiB.
  double random_4k_ms = 0;  ///< Median of single 4 KiB reads, one at a time.
};
/// @throws std::system_error  also where the file system has no O_DIRECT
[[nodiscard]] DeviceSpeed measure_device(const std::string& path);

}  // namespace ptin::bench
