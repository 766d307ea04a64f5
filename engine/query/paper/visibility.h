// SPDX-License-Identifier: GPL-3.0-or-later
//
// Visibility queries (paper, section 5.3): T0 is walked from p to q, and refined along the line only
// where the triangles leave open whether they occlude q.
#pragma once

#include "engine/query/sight/sight.h"

namespace ptin::paper {

/// A solver with the answers of one by stars, found as the paper has it. Where the full TIN was asked
/// for they are the same; at a level of detail or with a budget both are true.
/// @throws Error as SightSolver
/// Cost of an answer: the records whose region of influence meets what is refined of the line, and
/// for each step a walk over the triangles below the line.
[[nodiscard]] SightSolver sight_lines(const OpenedTerrain& terrain, const SightRequest& request);

}  // namespace ptin::paper
