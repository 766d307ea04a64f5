// SPDX-License-Identifier: GPL-3.0-or-later
//
// Measures of a line of sight once its pieces are decided: obstruction, clearance, Fresnel zone.
#pragma once

#include "engine/query/sight/sight.h"
#include "engine/query/sight/sight_line.h"

namespace ptin {

/// The state of the ground on which an end stands.
[[nodiscard]] PointState state_of(const SightEnd& end);

/// The point of the line at a share of its way.
/// @param length  Length of the line over ground, height's unit.
[[nodiscard]] SightPoint point_at(const SightPair& pair, const SightLine& line, double share,
                                  double length);

/// Measures the first obstruction, the smallest clearance, and what runs along the whole line
/// (voids, the Fresnel zone).
/// @returns whether all of that is as in the full TIN
/// @param wavelength  As SightRequest::wavelength.
/// @param result      `verdict` and `length` are set.
bool measure(const SightLine& line, const SightFacts& facts, const SightPair& pair,
             double wavelength, SightResult& result);

}  // namespace ptin
