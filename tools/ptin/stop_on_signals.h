// SPDX-License-Identifier: GPL-3.0-or-later
//
// SIGINT, SIGTERM and SIGHUP become a stop token.
#pragma once

#include <functional>
#include <stop_token>

namespace ptin::tools {

/// From this call on, the first SIGINT, SIGTERM or (unless it is ignored) SIGHUP fires the token,
/// so that work ends tidily with exit status 8; the second one ends the process as the signal does
/// by default. A write beyond the limit on the size of files fails, instead of ending the process
/// by SIGXFSZ. To be called once, before any other thread starts.
[[nodiscard]] std::stop_token stop_on_signals();

/// While it lives SIGHUP calls a function instead, on the thread of signals, one call after the other. Where
/// SIGHUP is ignored it stays so. There is one at once.
class OnHangUp {
 public:
  /// @param then  Throws nothing.
  explicit OnHangUp(std::function<void()> then);
  ~OnHangUp();  ///< Waits for a call at hand.
  OnHangUp(const OnHangUp&) = delete;
  OnHangUp& operator=(const OnHangUp&) = delete;
};

}  // namespace ptin::tools
