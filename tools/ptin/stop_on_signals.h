// SPDX-License-Identifier: GPL-3.0-or-later
//
// SIGINT and SIGTERM become a stop token.
#pragma once

#include <stop_token>

namespace ptin::tools {

/// From now on the first SIGINT or SIGTERM fires the token, so that work ends tidily with exit
/// status 8; the second one ends the process as the signal does by default. Called once, before any
/// other thread starts.
[[nodiscard]] std::stop_token stop_on_signals();

}  // namespace ptin::tools
