// SPDX-License-Identifier: GPL-3.0-or-later
//
// From triangles to a grid of heights, classes and pages.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "engine/query/terrain.h"
#include "tools/render/view.h"

namespace ptin::tools {

enum class PixelClass : std::uint8_t { kOutside, kSurface, kVoid };

/// What lies under the middle of each pixel.
struct TerrainRaster {
  int width = 0;
  int height = 0;
  std::vector<float> heights;  ///< Only where `classes` says kSurface.
  std::vector<PixelClass> classes;
  /// The page of each pixel's triangle; empty unless the TIN tells the pages of its triangles.
  std::vector<std::uint32_t> pages;

  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// Scans every triangle of `refined` over the pixels of `view`. A pixel whose middle lies on an
/// edge belongs to one of its two triangles. Cost: triangles plus pixels; memory:
/// raster_bytes_per_pixel().
/// @throws Error cancelled
[[nodiscard]] TerrainRaster rasterize(const RefinedTin& refined, const StoreFacts& facts,
                                      const View& view, const std::stop_token& stop = {});

/// Memory of a TerrainRaster, for each pixel.
[[nodiscard]] constexpr std::uint64_t raster_bytes_per_pixel(bool has_pages) {
  return sizeof(float) + sizeof(PixelClass) + (has_pages ? sizeof(std::uint32_t) : 0);
}

}  // namespace ptin::tools
