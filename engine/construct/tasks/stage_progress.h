// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a stage of a build is.
#pragma once

#include <cstdint>

namespace ptin {

struct StageProgress {
  /// The stage: "reading", "sorting", "collapsing", "tightening", "writing" ... A literal.
  const char* stage = "";
  /// Work done and all work, in a unit of the stage: bytes of text, samples, passes over points.
  std::uint64_t done = 0, total = 0;
  /// Leaves done and all leaves, in a stage that goes from leaf to leaf; both 0 in any other.
  std::uint64_t tiles_done = 0, tiles = 0;
};

}  // namespace ptin
