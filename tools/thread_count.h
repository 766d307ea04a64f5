// SPDX-License-Identifier: GPL-3.0-or-later
//
// What --threads means.
#pragma once

#include "engine/construct/process_limits.h"

namespace ptin::tools {

/// Threads to work on: those wanted, or allowed_threads() when `wanted` is 0.
[[nodiscard]] inline int thread_count(int wanted) {
  return wanted > 0 ? wanted : allowed_threads();
}

}  // namespace ptin::tools
