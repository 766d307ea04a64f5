// SPDX-License-Identifier: GPL-3.0-or-later
//
// The records of a simplified tile, held against engine/DESIGN.md, section 2.2, one by one: the collapses
// are done again on the full TIN, and everything is measured anew, at all samples and against all
// edges.
#pragma once

#include <string>

#include "tests/construct/test_terrain.h"

namespace ptin::oracle {

/// Replays the records of `terrain.tile` and returns the first fault in words, or an empty string:
/// a collapse that is not allowed, references, flags, roi, heights and rank that are not exactly
/// those of the definition, an error or deviation below the true one, or above it by more than its
/// rounding, and an end that is not the tile's mesh.
/// @param tight  Whether an error that is larger than it needs to be is a fault.
/// Cost: the square of the number of samples, at most; exact where it is close.
[[nodiscard]] std::string check_records(const TestTerrain& terrain, bool tight = true);

}  // namespace ptin::oracle
