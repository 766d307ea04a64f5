// SPDX-License-Identifier: GPL-3.0-or-later
//
// quantized-mesh 1.0, the format of Cesium's terrain.
#pragma once

#include <span>
#include <string>

#include "tools/tiles/ellipsoid.h"
#include "tools/tiles/tile_grid.h"
#include "tools/tiles/tile_pyramid.h"

namespace ptin::tools {

/// How a tile is written.
struct QuantizedMeshTarget {
  TileGrid grid;
  TileId tile;
  double height_step = 1.0;  ///< A power of two, metres: as TileLevel::height_step.
  bool has_normals = true;   ///< With the extension octvertexnormals.
};

/// The bytes of a tile. REQUIRES: at least one triangle; heights that are at most kTileSteps steps
/// apart and below 2^22 steps.
///
/// Heights are rounded to multiples of `height_step`, whatever tile they are in. A tile keeps a
/// height as a share of what is between its header's least and most one; so the least is the lowest
/// height h, and the most is h + 32767 t, where t is height_step halved as often as the tile's
/// heights allow. A decoder that computes least + q * ((most - least) / 32767) gets multiples of
/// height_step, exactly: the same numbers on both sides of a border. (Of `most` nothing is to be
/// learned: it is above the highest vertex by as much as the tile is high, at most, or by a few
/// metres.)
[[nodiscard]] std::string quantized_mesh(const TileMesh& mesh, const QuantizedMeshTarget& target);

/// The point by which a viewer knows that nothing of the positions can be seen beyond the horizon,
/// in units of the ellipsoid's axes, in the direction of `centre`. Where there is none, because
/// they reach around the Earth, it is so far away that it is hidden from the other side alone.
[[nodiscard]] Vec3 horizon_occlusion_point(const Vec3& centre, std::span<const Vec3> positions);

/// A unit vector in two bytes, as octvertexnormals has it: x, then y.
[[nodiscard]] std::array<std::uint8_t, 2> oct_encoded(const Vec3& unit) noexcept;

}  // namespace ptin::tools
