// SPDX-License-Identifier: GPL-3.0-or-later
//
// `refine --cut`: triangles cut at the border of a region.
#pragma once

#include "engine/query/questions.h"
#include "storage/store_file.h"
#include "tools/formats/mesh.h"

namespace ptin::tools {

/// The part of `refined` inside `region` (a window or a polygon): its surface triangles, cut at the
/// region's border. Void triangles are left out.
///
/// The border is inserted into the mesh as a chain of edges: triangles are split at the region's
/// corners, edges where the border crosses them. So neighbours share every cut point, and there is
/// no crack and no T-junction. A cut point of an edge of the TIN is computed from the ends of that
/// edge in a fixed order (on a window's side: from its coordinate alone), so two windows that share
/// a side get the same bits there. Heights are interpolated linearly.
///
/// Positions are decided exactly. Corners become spots as SpotMap rounds them, so that one given at a
/// vertex stands on it; cut points are rounded to spots too. The region's corners keep the caller's
/// own coordinates, and a cut point on a window's side keeps the coordinate of that side. A cut closer
/// to a vertex than spots can tell goes through that vertex. REQUIRES: `refined` holds every triangle that meets the region.
/// @throws Error invalid_argument  the region is a point or a segment, or a polygon reaches beyond
///                                 2^38 grid units
/// Cost: linear in the triangles, and for each corner of the region the walk to it from the corner
/// before. A corner outside of the mesh, and a side with both its ends outside, look at every
/// triangle.
[[nodiscard]] Mesh cut_to_region(const RefinedTin& refined, const StoreFacts& facts,
                                 const Region& region);

}  // namespace ptin::tools
