// SPDX-License-Identifier: GPL-3.0-or-later
//
// A small picture of a terrain from above: shaded relief, clear beside the terrain, for pages that list terrains.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/error.h"
#include "tools/plot/png.h"
#include "tools/render/rasterize.h"
#include "tools/render/relief.h"
#include "tools/render/view.h"
#include "tools/serve/answer_parts.h"
#include "tools/serve/questions.h"

namespace ptin::serve {

namespace {

constexpr std::uint32_t kLeastSide = 16, kMostSide = 1024;  // Pixels.
constexpr int kSamplesOfPixel = 2;                          // In each direction.

struct ThumbnailQuestion {
  std::uint32_t width = 320, height = 200;
};

void add_question(ask::Parameters& rows, ThumbnailQuestion& question) {
  const std::string most = "; the terrain is shown whole, in its middle";
  rows.add("width", &question.width, "", "Pixels across" + most)
      .within({.least = kLeastSide, .most = kMostSide})
      .with_default()
      .like("320");
  rows.add("height", &question.height, "", "Pixels down" + most)
      .within({.least = kLeastSide, .most = kMostSide})
      .with_default()
      .like("200");
}

tools::View view_of(const Collection& c, const ThumbnailQuestion& question) {
  const MapPoint middle{(c.bounds.min_x + c.bounds.max_x) / 2,
                        (c.bounds.min_y + c.bounds.max_y) / 2};
  return tools::make_view(c.bounds, c.ground.per_map_unit(middle), static_cast<int>(question.width),
                          static_cast<int>(question.height));
}

/// Memory of the samples and of two pictures.
std::uint64_t picture_bytes(const tools::View& view) {
  const auto pixels =
      static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);
  return pixels * (kSamplesOfPixel * kSamplesOfPixel * tools::raster_bytes_per_pixel(false) +
                   2 * sizeof(std::uint32_t));
}

/// What the picture shows: the full TIN where the file holds a raster's heights, which cost less than a
/// level and have no triangles across the sea; else a vertex for four pixels, since more would hardly be
/// seen, and cost as much again.
/// @throws Error resource_exhausted  the picture alone takes more than the question's memory
RasterResult sampled(const Asked& asked, const tools::View& view, tools::TerrainRaster& raster) {
  const std::uint64_t taken = picture_bytes(view);
  if (taken >= asked.limits.memory_bytes) {
    throw Error(ErrorCode::resource_exhausted, "the picture takes more than its memory");
  }
  DetailRequest detail;
  if (asked.terrain().store().floor() == nullptr) {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);
    const std::uint64_t least = asked.terrain().store().t0().vertices.size();
    detail.vertices =
        std::max(least, std::min<std::uint64_t>(pixels / 4, asked.options.question.vertices));
  }
  QueryLimits limits = asked.limits;
  limits.memory_bytes -= taken;
  return tools::sample_terrain(asked.terrain(), detail, limits,
                               tools::supersampled(view, kSamplesOfPixel), raster);
}

/// Pixels with an opacity: the share of a pixel's samples that lie on the terrain.
std::vector<std::uint32_t> with_opacity(const tools::Image& image,
                                        const tools::TerrainRaster& raster) {
  std::vector<std::uint32_t> pixels = image.pixels;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::uint32_t inside = 0;
      for (int k = 0; k < kSamplesOfPixel * kSamplesOfPixel; ++k) {
        const std::size_t at = raster.place(kSamplesOfPixel * x + k % kSamplesOfPixel,
                                            kSamplesOfPixel * y + k / kSamplesOfPixel);
        inside += raster.states[at] != PointState::kOutside ? 1U : 0U;
      }
      const std::uint32_t opacity = inside * 255U / (kSamplesOfPixel * kSamplesOfPixel);
      std::uint32_t& pixel = pixels[image.place(x, y)];
      pixel = opacity == 0 ? 0 : (opacity << 24 | (pixel & 0xffffffU));
    }
  }
  return pixels;
}

}  // namespace

ask::Parameters thumbnail_parameters() { return described<ThumbnailQuestion>(); }

http::Response answer_thumbnail(const Asked& asked) {
  const tools::View view = view_of(*asked.collection, read<ThumbnailQuestion>(asked));
  tools::TerrainRaster raster;
  const RasterResult found = sampled(asked, view, raster);
  const auto& stop = asked.limits.stop;
  const int reach = tools::pixels_between_samples(asked.facts().map, view) * kSamplesOfPixel;
  const tools::ReliefStyle style = tools::choose_style(raster, view, false, reach);
  const tools::Image image = tools::draw_relief(raster, view, kSamplesOfPixel, style, stop);
  return answered(asked, tools::png_of(image.width, image.height, with_opacity(image, raster)),
                  asked.formats.front().media, found);
}

}  // namespace ptin::serve
