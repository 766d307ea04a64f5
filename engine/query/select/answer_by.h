// SPDX-License-Identifier: GPL-3.0-or-later
//
// The two ways to an answer: by stars, and by splits.
#pragma once

#include <cstdint>

namespace ptin {

/// How an answer is found. Both ways give the same answer.
enum class AnswerBy : std::uint8_t {
  /// From the triangles that live at the level and meet the place (engine/DESIGN.md, section 2.10),
  /// found by the file's own index.
  kStars,
  /// As the paper has it: records are retrieved by the index in use, sorted topologically and
  /// applied to T0.
  kSplits,
};

}  // namespace ptin
