// SPDX-License-Identifier: GPL-3.0-or-later
//
// Isoline extraction (paper, section 5.2): T0 is refined where heights straddle a level, and each
// triangle of that one mesh that a level crosses is traced.
#pragma once

#include "engine/query/isoline/isoline.h"

namespace ptin::paper {

/// The lines of ptin::isolines(), found as the paper has it: the records with a level in their
/// interval [minh(v), maxh(v)], and in the request's region, are applied to T0. On one thread.
/// @throws Error as ptin::isolines(); resource_exhausted  the mesh does not fit half of the memory:
///                                                        refused before it is read
/// Cost: O(|T0| + k d) for k records of average degree d; O(n log n) in the lines.
[[nodiscard]] Isolines isolines(const OpenedTerrain& terrain, const IsolineRequest& request);

}  // namespace ptin::paper
