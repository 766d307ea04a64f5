// SPDX-License-Identifier: GPL-3.0-or-later
//
// The system's page cache: dropping a file from it, asking how much of a file is in it, and what a
// step of a benchmark made the system read.
#pragma once

#include <cstdint>
#include <string>

namespace ptin::bench {

/// Drops the pages of a file from the cache (sync, then posix_fadvise DONTNEED, up to 20 times).
/// Returns the bytes that are resident all the same, by mincore: 0 means that the file is cold.
/// Mapped pages stay, so close every store on the file before.
/// @throws std::system_error
std::uint64_t drop_from_cache(const std::string& path);

/// Bytes of the file that are in the page cache.  @throws std::system_error
[[nodiscard]] std::uint64_t resident_bytes(const std::string& path);

/// What this process has made the system read since it began.
struct SystemReads {
  /// read_bytes of /proc/self/io: bytes asked of the block layer, read-ahead included.
  std::uint64_t device_bytes = 0;
  std::uint64_t major_faults = 0;  ///< Faults that waited for the device.
  std::uint64_t minor_faults = 0;

  [[nodiscard]] static SystemReads now();
  [[nodiscard]] SystemReads since(const SystemReads& before) const {
    return {device_bytes - before.device_bytes, major_faults - before.major_faults,
            minor_faults - before.minor_faults};
  }
};

/// How fast the device under a file is, read around the page cache (O_DIRECT).
struct DeviceSpeed {
  /// Best of five passes of 8 readers, in blocks of 1 MiB, over at most 512 MiB.
  double sequential_mb_s = 0;
  double random_4k_ms = 0;  ///< Median of single 4 KiB reads, one at a time.
};
/// @throws std::system_error  also: the file system has no O_DIRECT
[[nodiscard]] DeviceSpeed measure_device(const std::string& path);

}  // namespace ptin::bench
