// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the triangles of a T0 cover a convex domain exactly once.
#pragma once

#include <string>
#include <vector>

#include "storage/store_file.h"

namespace ptin {

/// What is wrong with a T0, as sentences; empty when T0 is a triangulation of a convex domain whose
/// box is `bounds`. REQUIRES: fault_in(t0, facts) is null (storage/coarsest_tin.h). Cost: O(n log
/// n).
[[nodiscard]] std::vector<std::string> faults_of_cover(const CoarsestTin& t0,
                                                       const GridBox& bounds);

}  // namespace ptin
