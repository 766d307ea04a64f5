// SPDX-License-Identifier: GPL-3.0-or-later
//
// The ways in which the bytes of a question come from the disk.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "engine/query/questions.h"

namespace ptin::tools {

enum class ReadWay : std::uint8_t {
  kAnnounced,  ///< Mapped; reads are announced to the kernel. What `ptin` does by itself.
  kFaults,     ///< Mapped, and nothing is announced: each page waits for a fault of its own.
  kPread,      ///< By pread, announced. `--no-mmap`.
  kUring,      ///< Mapped; what is read next comes through io_uring.
};
inline constexpr std::array kReadWays = {ReadWay::kAnnounced, ReadWay::kFaults, ReadWay::kPread,
                                         ReadWay::kUring};

/// "announced", "faults", "pread", "io_uring".
[[nodiscard]] const char* name_of(ReadWay way) noexcept;

/// Opens terrains by any way. What the ways share is made once: the ring of io_uring.
/// Threads: one owner.
class TerrainOpener {
 public:
  /// @throws Error as StoreFile::open; io_error for kUring where there is no io_uring
  [[nodiscard]] Terrain open(const std::string& path, ReadWay way);

 private:
  std::shared_ptr<Announcer> uring_;
};

}  // namespace ptin::tools
