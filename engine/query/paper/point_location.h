// SPDX-License-Identifier: GPL-3.0-or-later
//
// Point location (paper, section 5.1): the query region of selective refinement is the point itself.
#pragma once

#include <span>

#include "engine/query/heights/locate.h"

namespace ptin::paper {

/// The answers of ptin::locate(), found as the paper has it: the records whose region of influence
/// holds a point are applied to T0, and the triangle in which the point lies is found by a walk.
/// Points come in groups along the Hilbert curve, which share what they read.
/// @throws Error as ptin::locate(); resource_exhausted  a single point's records, beside the results,
///                                                      exceed the memory limit
/// Cost: for one point O(|T0| + k d) for k records of average degree d, O(log n) of them in practice;
/// for a group the records that any of its points needs, each read and applied once.
[[nodiscard]] LocateResult locate(const OpenedTerrain& terrain, std::span<const MapPoint> points,
                                  const LocateRequest& request);

}  // namespace ptin::paper
