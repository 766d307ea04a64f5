// SPDX-License-Identifier: GPL-3.0-or-later
//
// A tile as glTF 2.0 binary, for 3D Tiles.
#pragma once

#include <string>

#include "tools/tiles/tile_grid.h"
#include "tools/tiles/tile_pyramid.h"

namespace ptin::tools {

struct TileGlbTarget {
  TileGrid grid;
  TileId tile;
  double position_step = 1.0;  ///< A power of two, metres.
};

/// The bytes of a tile; of a mesh without triangles those of an empty scene. Positions are
/// earth-centred (ECEF), y up as glTF wants: (x, z, -y). They are float32 around an origin that the
/// node's translation has in double. Origin and positions are multiples of `position_step`, exact
/// in float32: so translation + position are the same doubles on both sides of a border.
/// REQUIRES: a tile smaller than 2^23 steps.
[[nodiscard]] std::string tile_glb(const TileMesh& mesh, const TileGlbTarget& target);

}  // namespace ptin::tools
