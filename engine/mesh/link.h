// SPDX-License-Identifier: GPL-3.0-or-later
//
// Neighbours of triangles, and a triangle of each vertex, from corners alone.
#pragma once

#include "engine/mesh/tin.h"

namespace ptin {

/// Fills Triangle::n and Vertex::triangle.
/// REQUIRES: counter-clockwise triangles of which no two lie on the same side of an edge.
/// Cost: O(n log n); 16 bytes a side.
void link_tin(Tin& tin);

}  // namespace ptin
