// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far a stage of a build is.
#pragma once

#include <cstdint>

namespace ptin {

struct StageProgress {
  /// The stage: "reading", "sorting", "collapsing", "tightening", "writing" ... A literal.
  const char* stage = "";
  /// In units of the stage's own: bytes of text, samples, passes over points.
  std::uint64_t done = 0, total = 0;
  /// Leaves of the tree of tiles, of the stages that go through them; 0 of all others.
  std::uint64_t tiles_done = 0, tiles = 0;
};

}  // namespace ptin
