// SPDX-License-Identifier: GPL-3.0-or-later
//
// The invariants of a TIN, numbered, in one place.
#pragma once

#include <cstdint>
#include <string>

#include "engine/mesh/tin.h"

namespace ptin {

/// Checks every invariant; returns an empty string, or the first one broken in words ("I2: triangle
/// 7 ...").
///
/// - I1, orientation: every triangle is strictly counter-clockwise, its corners alive, distinct and
///   on the grid.
/// - I2, neighbours: symmetric, across the same two vertices.
/// - I3, one cover: connected, and V - E + F = 1, a disk; the sum of the areas equals the area
///   inside of the border, so with I1 every point is covered once.
/// - I4, border: one closed chain, counter-clockwise round the domain, once; the domain is convex.
/// - I5, classes: a surface triangle has three vertices with heights.
/// - I6, vertices: every vertex's triangle holds it; on the border it is the first of the
///   counter-clockwise walk; the walk visits every triangle that holds the vertex.
///
/// Cost: linear, with hashing of vertices; for tests and debugging.
[[nodiscard]] std::string validate(const Tin& tin);

/// Twice the area of all triangles, exactly. REQUIRES: they cover a domain once, so that the sum
/// fits: the grid has 2^30 steps a side, and the sum is at most 2^61.
[[nodiscard]] std::int64_t twice_area(const Tin& tin);

}  // namespace ptin
