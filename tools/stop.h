// SPDX-License-Identifier: GPL-3.0-or-later
//
// Looking at the stop token in long loops.
#pragma once

#include <stop_token>
#include <string>

#include "engine/error.h"

namespace ptin::tools {

/// @param what  That is stopped, for the message: "drawing".
/// @throws Error cancelled  when the stop token fired
inline void stop_if_asked(const std::stop_token& stop, const char* what) {
  if (stop.stop_requested())
    throw Error(ErrorCode::cancelled, std::string(what).append(" was stopped"));
}

}  // namespace ptin::tools
