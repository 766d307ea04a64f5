// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files of another machine that show late.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>

namespace ptin {

/// Waits until something of this name is there, at most for `patience`. A client of a network file
/// system keeps for a while that a name was not there, or what a folder held; reading the folder
/// makes it ask anew, so that is done before each look.
/// @return False when it is not there.
/// @throws Error cancelled  `stop` fired while it waited; io_error  as is_there()
bool await_file(const std::string& path, std::chrono::milliseconds patience,
                const std::stop_token& stop);

}  // namespace ptin
