// SPDX-License-Identifier: GPL-3.0-or-later
//
// Costs: in which order vertices go (engine/DESIGN.md, section 5.1; PriorityScale has every term).
#pragma once

#include <cstdint>

namespace ptin {

enum class CostModel : std::uint8_t {
  kError,      ///< Smallest class of the sample error, a third of an octave wide; then the box.
  kRoi,        ///< Smallest saturated box (the paper's for point location).
  kElevation,  ///< Smallest saturated height interval (the paper's for isolines); then the box.
};

}  // namespace ptin
