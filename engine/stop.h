// SPDX-License-Identifier: GPL-3.0-or-later
//
// How triangulations are stopped. For *delaunay*.cc alone.
#pragma once

#include <cstddef>
#include <stop_token>

#include "engine/error.h"

namespace ptin::delaunay_internal {

/// Insertions between two looks at the stop token.
inline constexpr std::size_t kBetweenStops = 4096;

/// @throws Error cancelled  `stop` fired
inline void check_stop(const std::stop_token& stop) {
  if (stop.stop_requested()) {
    throw Error(ErrorCode::cancelled, "the triangulation was cancelled");
  }
}

}  // namespace ptin::delaunay_internal
