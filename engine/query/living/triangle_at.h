// SPDX-License-Identifier: GPL-3.0-or-later
//
// The living triangle at a spot.
#pragma once

#include <cstdint>
#include <span>

#include "engine/query/living/floor_cells.h"
#include "engine/query/living/living_triangle.h"
#include "engine/query/living/spot_in_triangle.h"
#include "engine/query/select/accounting.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/walk/walk.h"
#include "storage/floor.h"

namespace ptin {

/// True when the closed triangle holds the spot. Exact.
[[nodiscard]] inline bool holds(const LivingTriangle& t, Spot q) noexcept {
  return triangle_holds(t.corner[0].position, t.corner[1].position, t.corner[2].position, q);
}

/// The closed triangle of a level that answers for a spot: of several a surface one before a void
/// one, then the one whose corners' keys, in ascending order, come first.
struct TriangleAt {
  LivingTriangle triangle;
  bool is_found = false;
  bool is_inside = false;  ///< The spot lies on no side, so that no other triangle holds it.
};

/// The same of the full TIN of a raster, for a spot that is not FloorAtSpots::within() one.
/// @throws Error corruption, io_error
[[nodiscard]] TriangleAt triangle_on_sides(FloorAtSpots& triangles, Spot spot, QueryCost& cost);

/// Finds the triangles at spots.
/// @param detail Of which level.
/// @param spots  In the bounds of the terrain. Spots that lie close together cost less.
/// @param found  As many; receives the answers. One that is not found lies outside of the domain.
/// @param held   Bytes that the caller holds, to which triangles are added that a number of vertices
///               has not decided yet (LivingTies).
/// @param recent What the caller read of the raster's heights lately, which is not read again; null: nothing.
/// @throws Error corruption, io_error, cancelled; resource_exhausted where these do not fit
/// Cost: of the full TIN of a file with heights of a raster the tiles of the spots (FloorAtSpots). Else
/// of one spot the nodes and pages whose stars may hold it, those of small boxes first, until
/// a triangle holds it within; of many spots in a small region the pages of the region.
void find_triangles(const OpenedTerrain& terrain, const Detail& detail, std::span<const Spot> spots,
                    std::span<TriangleAt> found, std::uint64_t held, QueryContext& context,
                    Floor::Recent* recent = nullptr);

}  // namespace ptin
