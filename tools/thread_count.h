// SPDX-License-Identifier: GPL-3.0-or-later
//
// What --threads means.
#pragma once

#include <algorithm>
#include <thread>

namespace ptin::tools {

/// Threads to work on: those wanted, or one a core when `wanted` is 0.
[[nodiscard]] inline int thread_count(int wanted) {
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace ptin::tools
