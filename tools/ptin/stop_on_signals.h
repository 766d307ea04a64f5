// SPDX-License-Identifier: GPL-3.0-or-later
//
// SIGINT, SIGTERM and SIGHUP become a stop token.
#pragma once

#include <stop_token>

namespace ptin::tools {

/// From this call on, the first SIGINT, SIGTERM or (unless it is ignored) SIGHUP fires the token,
/// so that work ends tidily with exit status 8; the second one ends the process as the signal does
/// by default. A write beyond the limit on the size of files fails, instead of ending the process
/// by SIGXFSZ. To be called once, before any other thread starts.
[[nodiscard]] std::stop_token stop_on_signals();

}  // namespace ptin::tools
