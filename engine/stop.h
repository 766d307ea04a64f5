// SPDX-License-Identifier: GPL-3.0-or-later
//
// How long loops ask whether they are to stop. (A query asks by its QueryContext.)
#pragma once

#include <cstddef>
#include <stop_token>
#include <string>

#include "engine/error.h"

namespace ptin {

/// Steps of a long loop between two looks at the stop token.
inline constexpr std::size_t kStopInterval = 4096;

/// Asks a stop token. Long loops call this every few thousand steps, so that a caller who asks for
/// a stop waits for milliseconds.
/// @param what     What is stopped, as the subject of a sentence: "the build", "sorting".
/// @param context  The file that the error names; none by default.
/// @throws Error cancelled  a stop was requested
/// Cost: one atomic load.
inline void stop_if_asked(const std::stop_token& stop, const char* what,
                          const std::string& context = {}) {
  if (stop.stop_requested()) [[unlikely]] {
    throw Error(ErrorCode::cancelled, std::string(what) + " was cancelled", context);
  }
}

}  // namespace ptin
