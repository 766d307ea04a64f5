// SPDX-License-Identifier: GPL-3.0-or-later
//
// Heights of pixels whose centres are samples of a raster, copied from its tiles.
#pragma once

#include <functional>

#include "engine/query/raster/pixel_centres.h"
#include "engine/query/raster/pixel_sampler.h"
#include "engine/query/select/accounting.h"
#include "storage/floor.h"

namespace ptin {

/// Whether copy_floor() gives the heights of pixels: each centre in the box of the terrain is a sample,
/// and there are as many as tiles at least.
[[nodiscard]] bool are_on_floor(const FloorShape& shape, const PixelCentres& centres);

/// Gives pixels what the full TIN is at their centres: that of a sample with a height its height, and a
/// void one, or a lone one, touches void triangles alone.
/// @param buffers  Cleared, as PixelSampler does. States may be empty.
/// @param between  Called now and then.
/// REQUIRES: are_on_floor()
/// @throws Error corruption, io_error; what `between` throws
/// Cost: the tiles that hold centres, and 2 ns a sample of them; 16 bytes a tile.
void copy_floor(const Floor& floor, const HeightEncoding& heights, const PixelCentres& centres,
                const PixelBuffers<double>& buffers, const std::function<void()>& between,
                QueryCost& cost);

}  // namespace ptin
