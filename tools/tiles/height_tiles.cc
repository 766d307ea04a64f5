// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/tiles/height_tiles.h"

#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

/// The heights that three bytes hold: metres = least + step * number.
struct HeightScale {
  double least, step;
};
constexpr double kNumbers = 16777216.0;

HeightScale scale_of(HeightCode code) noexcept {
  return code == HeightCode::kMapbox ? HeightScale{-10000.0, 0.1}
                                     : HeightScale{-32768.0, 1.0 / 256};
}

/// The number of a height; one outside of three bytes where the encoding does not hold it. Tenths are
/// counted from the quotient: 0.1 is no double, 10 is.
double number_of_height(HeightCode code, double metres) noexcept {
  const double above = metres - scale_of(code).least;
  return std::round(code == HeightCode::kMapbox ? above * 10.0 : above * 256.0);
}

/// Puts the colours of heights.
std::vector<std::uint8_t> pixels_of(std::span<const double> heights, double metres_per_height,
                                    const HeightTileStyle& style) {
  std::vector<std::uint8_t> pixels(heights.size() * 4);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const bool is_surface = !std::isnan(heights[i]);
    // Heights of the terrain are within the encoding's; rounding may lead a step beyond its end.
    const double number =
        number_of_height(style.code, is_surface ? heights[i] * metres_per_height : 0.0);
    const auto bits = static_cast<std::uint32_t>(std::clamp(number, 0.0, kNumbers - 1));
    pixels[4 * i] = static_cast<std::uint8_t>(bits >> 16U);
    pixels[4 * i + 1] = static_cast<std::uint8_t>(bits >> 8U & 255U);
    pixels[4 * i + 2] = static_cast<std::uint8_t>(bits & 255U);
    pixels[4 * i + 3] = is_surface || style.fills_voids ? 255 : 0;
  }
  return pixels;
}

}  // namespace

std::string_view name_of(HeightCode code) noexcept {
  return code == HeightCode::kMapbox ? "mapbox" : "terrarium";
}

std::string_view name_of(TileFormat format) noexcept {
  return format == TileFormat::kPng ? "png" : "webp";
}

std::string_view media_of(TileFormat format) noexcept {
  return format == TileFormat::kPng ? "image/png" : "image/webp";
}

double step_of(HeightCode code) noexcept { return scale_of(code).step; }

void check_heights(const MercatorPyramid& pyramid, HeightCode code) {
  const Globe& globe = pyramid.globe();
  const double low = number_of_height(code, globe.min_height());
  const double high = number_of_height(code, globe.max_height());
  if (low >= 0 && high < kNumbers) return;
  const HeightScale scale = scale_of(code);
  refuse("tiles of the encoding " + std::string(name_of(code)) + " hold heights from " +
         std::to_string(scale.least) + " m to " +
         std::to_string(scale.least + (kNumbers - 1) * scale.step) +
         " m, and the terrain's are from " + std::to_string(globe.min_height()) + " m to " +
         std::to_string(globe.max_height()) + " m");
}

int last_zoom(const MercatorPyramid& pyramid, const HeightTileStyle& style) noexcept {
  return pyramid.finest_level() - style.beyond_zoom();
}

std::optional<Tile> height_tile(const MercatorPyramid& pyramid, const HeightTileStyle& style,
                                const WebTile& tile, const QueryLimits& limits) {
  if (tile.z > last_zoom(pyramid, style) || !pyramid.has(tile.z, tile.x, tile.y)) {
    return std::nullopt;
  }
  check_heights(pyramid, style.code);
  const auto side = static_cast<std::size_t>(style.side);
  // Positions, heights and pixels; what the file takes is less than what is free by then.
  constexpr std::uint64_t kBytesOfPixel = sizeof(MapPoint) + sizeof(double) + 8;
  const std::uint64_t bytes = kBytesOfPixel * side * side;
  if (limits.memory_bytes < bytes) {
    throw Error(ErrorCode::resource_exhausted, "a tile takes " + std::to_string(bytes) +
                                                   " bytes of memory, and has " +
                                                   std::to_string(limits.memory_bytes));
  }
  const int level = tile.z + style.beyond_zoom();
  std::vector<MapPoint> centres(side * side);
  pyramid.place_pixels(level, pyramid.unrolled_column(tile) * style.side, tile.y * style.side,
                       style.side, centres);
  stop_if_asked(limits.stop, "the tile");
  LocateRequest request;
  request.detail = pyramid.level(level).detail;
  request.limits = limits;
  request.limits.memory_bytes -= bytes;
  std::vector<double> heights(centres.size());
  const RasterResult result = pyramid.terrain().heights_at(centres, request, heights);
  const double metres = pyramid.globe().metres_per_height();
  Tile made;
  made.bytes = tile_image(style.format, style.side, pixels_of(heights, metres, style));
  made.error = result.certified_error * metres + step_of(style.code) / 2;
  made.cost = result.cost;
  return made;
}

nlohmann::json height_facts(const MercatorPyramid& pyramid, const HeightTileStyle& style) {
  nlohmann::json errors = nlohmann::json::array();
  for (int z = 0; z <= last_zoom(pyramid, style); ++z) {
    errors.push_back(pyramid.level(z + style.beyond_zoom()).error + step_of(style.code) / 2);
  }
  nlohmann::json facts = {{"encoding", name_of(style.code)},
                          {"tile_size", style.side},
                          {"format", name_of(style.format)},
                          {"voids", style.fills_voids ? "fill" : "transparent"},
                          {"ptin:unit", "m"},
                          {"ptin:errors", std::move(errors)}};
  facts.update(pyramid.place_facts(last_zoom(pyramid, style)));
  return facts;
}

}  // namespace ptin::tools
