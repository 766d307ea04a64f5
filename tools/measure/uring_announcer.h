// SPDX-License-Identifier: GPL-3.0-or-later
//
// Announcements through io_uring: what a store reads next is read by the ring into the page cache,
// many reads at once, and the store finds it there or waits for it.
#pragma once

#include <memory>
#include <string>

#include "storage/file/announcer.h"

namespace ptin::tools {

/// Why there is no io_uring, as the end of a sentence: the program was built without liburing, or
/// the kernel refuses it. Empty when there is.
[[nodiscard]] std::string why_no_uring();

/// At most 64 reads of 128 KiB are under way at once; an announcement beyond these waits for one.
/// Holds 8 MiB. Threads take turns.
class UringAnnouncer final : public Announcer {
 public:
  /// @throws Error io_error  what why_no_uring() says
  UringAnnouncer();
  ~UringAnnouncer() override;  ///< Waits for what is under way.

  void announce(int descriptor, std::uint64_t offset, std::uint64_t bytes) noexcept override;

 private:
  class Ring;
  std::unique_ptr<Ring> ring_;
};

}  // namespace ptin::tools
