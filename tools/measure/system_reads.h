// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the system has read for this process.
#pragma once

#include <cstdint>
#include <optional>

namespace ptin::tools {

/// Counts of the process since it began, or between two moments.
struct SystemReads {
  /// read_bytes of /proc/self/io: bytes asked of the block layer, read-ahead included. None where
  /// the system does not say.
  std::optional<std::uint64_t> device_bytes;
  std::uint64_t major_faults = 0;  ///< Faults that waited for the device.

  [[nodiscard]] static SystemReads now();
  [[nodiscard]] SystemReads since(const SystemReads& before) const;
};

}  // namespace ptin::tools
