// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/construct/raster/raster_tile.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/construct/grid/crs.h"
#include "engine/construct/raster/raster_surface.h"
#include "engine/construct/raster/raster_tin.h"
#include "engine/construct/raster/void_depth.h"

namespace ptin {

namespace {

/// Depths need the samples within the cut-off; whether the last of these are lone, the cells around
/// them tell: hence one more.
constexpr std::int64_t kMargin = kVoidDepthCutOff + 1;

SampleRange with_margin(const RasterSource& source, const SampleRange& window) {
  if (source.void_samples() == 0) {
    return window;
  }
  const std::int64_t x0 = std::max<std::int64_t>(window.x0 - kMargin, 0);
  const std::int64_t y0 = std::max<std::int64_t>(window.y0 - kMargin, 0);
  return {x0, y0, std::min(window.x0 + window.width + kMargin, source.width()) - x0,
          std::min(window.y0 + window.height + kMargin, source.height()) - y0};
}

template <class T>
std::vector<T> cut_out(const std::vector<T>& from, const SampleRange& outer,
                       const SampleRange& inner) {
  if (outer.width == inner.width && outer.height == inner.height) {
    return from;
  }
  std::vector<T> part(static_cast<std::size_t>(inner.width * inner.height));
  for (std::int64_t y = 0; y < inner.height; ++y) {
    const auto* row = from.data() + (inner.y0 - outer.y0 + y) * outer.width + (inner.x0 - outer.x0);
    std::copy_n(row, inner.width, part.data() + y * inner.width);
  }
  return part;
}

std::vector<float> depths_of(const RasterSource& source, const std::vector<std::uint8_t>& valid,
                             const SampleRange& outer, const SampleRange& inner) {
  std::vector<float> depths(static_cast<std::size_t>(inner.width * inner.height));
  const GroundMetric metric(source.frame());
  void_depth(
      {valid, outer.width, outer.height, inner.x0 - outer.x0, inner.y0 - outer.y0, inner.width,
       inner.height},
      [&](std::int64_t y) { return metric.at(static_cast<double>(outer.y0 + y)); },
      kVoidDepthCutOff, depths);
  return depths;
}

}  // namespace

StartedTile start_raster_tile(const RasterSource& source, const SampleRange& window,
                              const MeasureUnits& units) {
  StartedTile started;
  const SampleRange outer = with_margin(source, window);
  const auto samples = static_cast<std::size_t>(outer.width * outer.height);
  std::vector<HeightBits> heights(samples);
  std::vector<std::uint8_t> valid(samples);
  source.read(outer.x0, outer.y0, outer.width, outer.height, heights, valid);
  std::vector<float> depths;
  if (source.void_samples() != 0) {
    for (const std::uint64_t i : find_lone_samples(valid, outer.width, outer.height)) {
      valid[i] = 0;
      const std::int64_t x = outer.x0 + static_cast<std::int64_t>(i) % outer.width - window.x0;
      const std::int64_t y = outer.y0 + static_cast<std::int64_t>(i) / outer.width - window.y0;
      started.lone_samples += x >= 0 && y >= 0 && x < window.width && y < window.height ? 1 : 0;
    }
    depths = depths_of(source, valid, outer, window);
    heights = cut_out(heights, outer, window);
    valid = cut_out(valid, outer, window);
  }
  const GridPoint origin{static_cast<std::int32_t>(window.x0),
                         static_cast<std::int32_t>(window.y0)};
  const auto width = static_cast<std::int32_t>(window.width);
  const auto height = static_cast<std::int32_t>(window.height);
  started.box = {origin.x, origin.y, origin.x + width - 1, origin.y + height - 1};
  started.tile.units = units;
  started.tile.samples_fill_grid = true;
  started.tile.tin = make_raster_tin(heights, valid, width, height, units.heights, origin);
  start_tile(started.tile, depths);
  started.full = std::make_unique<RasterSurface>(std::move(heights), std::move(valid), width,
                                                 height, units.heights, origin);
  return started;
}

}  // namespace ptin
