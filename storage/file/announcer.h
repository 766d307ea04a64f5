// SPDX-License-Identifier: GPL-3.0-or-later
//
// Announces to the system which parts of a file are read next.
#pragma once

#include <cstdint>

namespace ptin {

/// Hears of the ranges that a store will read, before it reads them. A store without one of its own
/// tells the kernel (posix_fadvise, WILLNEED). Threads: called from several at once.
class Announcer {
 public:
  Announcer() = default;
  Announcer(const Announcer&) = delete;
  Announcer& operator=(const Announcer&) = delete;
  virtual ~Announcer() = default;

  /// Starts reading a range of an open file into the system's page cache. A hint: never fails, and
  /// the store reads the range in any case.
  /// @param descriptor  The file's; open as long as the store is.
  virtual void announce(int descriptor, std::uint64_t offset, std::uint64_t bytes) noexcept = 0;
};

}  // namespace ptin
