// SPDX-License-Identifier: GPL-3.0-or-later
//
// The triangles of a mesh that meet a region, as a mesh of their own.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/mesh/tin.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/region.h"

namespace ptin {

/// Keeps the triangles that meet `region`, and their vertices; both are renumbered and keep their
/// order. Neighbours that went become kNone. What is left need not be a disk: it may be empty or in
/// pieces. Where two pieces touch in one vertex, Vertex::triangle is a triangle of one of the
/// pieces, on the border the first of a counter-clockwise walk.
/// @param pages  Empty, or one entry for each triangle; the entries of triangles that stay are
///               kept.
/// @throws Error cancelled
/// Cost: linear.
void keep_meeting(Tin& tin, const GridRegion& region, std::vector<std::uint32_t>& pages,
                  const QueryContext& context);

}  // namespace ptin
