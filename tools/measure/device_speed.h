// SPDX-License-Identifier: GPL-3.0-or-later
//
// How fast the device under a file is.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

namespace ptin::tools {

/// Read around the page cache (O_DIRECT). What lies below it (the disk's own memory, the host of a
/// virtual machine) serves these reads too.
struct DeviceSpeed {
  /// The best of up to five passes of 8 readers over the same blocks of 1 MiB, at most 512 of them.
  double sequential_mb_s = 0;  ///< 10^6 bytes a second.
  double random_4k_ms = 0;     ///< Median of single reads of 4 KiB at seeded places, one at a time.
};

/// None where the file system reads nothing around its cache, or the file is shorter than 4 KiB.
/// Cost: about three seconds, less where the device is fast.
/// @throws Error not_found, io_error, cancelled
[[nodiscard]] std::optional<DeviceSpeed> measure_device(const std::string& path,
                                                        const std::stop_token& stop);

}  // namespace ptin::tools
