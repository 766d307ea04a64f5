// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/relief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/mesh/tin.h"
#include "engine/stop.h"
#include "tools/slope.h"

namespace ptin::tools {

namespace {

constexpr Colour kBackground{255, 255, 255};

struct Stop {
  float at;
  Colour colour;
};
constexpr std::array<Stop, 8> kRamp = {{{0.00F, {104, 150, 116}},
                                        {0.12F, {143, 177, 124}},
                                        {0.28F, {193, 204, 146}},
                                        {0.45F, {226, 213, 162}},
                                        {0.62F, {208, 176, 131}},
                                        {0.78F, {178, 141, 115}},
                                        {0.90F, {190, 174, 168}},
                                        {1.00F, {250, 250, 250}}}};

/// Horn's slope at a pixel: weighted differences of the eight pixels around it, `reach` away. A
/// pixel without a height counts as the middle one.
Slope slope_at(const TerrainRaster& r, int x, int y, double ground_per_pixel, int reach) {
  const float centre = r.heights[r.place(x, y)];
  double z[3][3];
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int px = std::clamp(x + dx * reach, 0, r.width - 1);
      const int py = std::clamp(y + dy * reach, 0, r.height - 1);
      const std::size_t place = r.place(px, py);
      z[dy + 1][dx + 1] = r.states[place] == PointState::kSurface ? r.heights[place] : centre;
    }
  }
  const double run = 8.0 * reach * ground_per_pixel;
  return {((z[0][2] + 2 * z[1][2] + z[2][2]) - (z[0][0] + 2 * z[1][0] + z[2][0])) / run,
          ((z[0][0] + 2 * z[0][1] + z[0][2]) - (z[2][0] + 2 * z[2][1] + z[2][2])) / run};
}

bool is_level_sea(float height, const Slope& slope) {
  return height == 0.0F && slope.east == 0.0 && slope.north == 0.0;
}

/// The light from the north-west, 45 degrees high, on a slope drawn steeper than it is.
double light_on(const Slope& slope, double exaggeration) {
  static const Light kLight(315, 45);
  return kLight.on({slope.east * exaggeration, slope.north * exaggeration});
}

/// A colour for each page, neighbours in number far apart in hue.
Colour page_colour(std::uint32_t page) {
  if (page == kNone) return {214, 214, 214};
  const double hue = std::fmod(page * 0.618033988749895, 1.0) * 6.0;
  const float value = page % 3 == 0 ? 225.0F : (page % 3 == 1 ? 245.0F : 200.0F);
  constexpr float kPale = 0.42F;
  Colour colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double distance =
        std::abs(std::fmod(hue + 6.0 - 2.0 * static_cast<double>(i) + 3.0, 6.0) - 3.0);
    const float strength = static_cast<float>(std::clamp(2.0 - distance, 0.0, 1.0));
    colour[i] = value * (kPale + (1.0F - kPale) * strength);
  }
  return colour;
}

Colour pixel_colour(const TerrainRaster& raster, int x, int y, double ground_per_pixel, int factor,
                    const ReliefStyle& style) {
  const std::size_t place = raster.place(x, y);
  if (raster.states[place] == PointState::kOutside) return kBackground;
  if (raster.states[place] == PointState::kVoid) {
    return (x + y) / factor % style.hatching == 0 ? kHatchColour : kVoidColour;
  }
  const Slope slope = slope_at(raster, x, y, ground_per_pixel, style.reach);
  const float height = raster.heights[place];
  const bool is_water = is_level_sea(height, slope) && style.high > 0.0F;
  Colour colour = style.by_page ? page_colour(raster.pages[place]) : height_colour(height, style);
  if (is_water && !style.by_page) return kWaterColour;
  const double light = std::max(0.0, light_on(slope, style.exaggeration));
  // Flat ground keeps its colour; shades are a little blue, lights go towards white.
  const double flat = std::sqrt(0.5);
  if (light < flat) {
    const auto dark = static_cast<float>(1.0 - light / flat);
    return mixed(colour, {colour[0] * 0.16F, colour[1] * 0.18F, colour[2] * 0.30F}, dark * 0.95F);
  }
  return mixed(colour, {255, 253, 244}, static_cast<float>((light - flat) / (1.0 - flat) * 0.55));
}

}  // namespace

ReliefStyle choose_style(const TerrainRaster& raster, const View& view, bool by_page, int reach) {
  ReliefStyle style;
  style.reach = reach;
  style.by_page = by_page;
  std::vector<float> heights;
  float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
  double squares = 0.0;
  const int step = std::max(1, std::max(raster.width, raster.height) / 600);
  const double ground = view.ground_per_pixel() * view.width / raster.width;
  for (int y = 0; y < raster.height; y += step) {
    for (int x = 0; x < raster.width; x += step) {
      style.any_void |= raster.states[raster.place(x, y)] == PointState::kVoid;
      if (raster.states[raster.place(x, y)] != PointState::kSurface) continue;
      const float height = raster.heights[raster.place(x, y)];
      lowest = std::min(lowest, height), highest = std::max(highest, height);
      const Slope slope = slope_at(raster, x, y, ground, style.reach);
      style.any_water |= is_level_sea(height, slope);
      if (slope.east == 0.0 && slope.north == 0.0) continue;
      heights.push_back(height);
      squares += slope.east * slope.east + slope.north * slope.north;
    }
  }
  if (heights.empty()) {  // level, or no surface at all
    const bool is_level = lowest <= highest;
    style.low = is_level ? lowest : 1.0F;
    style.high = is_level ? lowest : 0.0F;
    style.any_above = is_level && highest > lowest;
    return style;
  }
  std::sort(heights.begin(), heights.end());
  const float middle = heights[heights.size() / 2];
  const float first = heights[heights.size() / 50];
  const float last = heights[heights.size() - 1 - heights.size() / 50];
  style.low = std::max(lowest, first - (middle - first));
  style.high = std::min(highest, last + (last - middle));
  style.any_water &= style.high > 0.0F && !by_page;
  style.any_below = lowest < style.low;
  style.any_above = highest > style.high;
  constexpr double kPleasantSlope = 0.38;  // The root mean square of slopes in mountains.
  const double slope = std::sqrt(squares / static_cast<double>(heights.size()));
  style.exaggeration = slope > 0 ? std::clamp(kPleasantSlope / slope, 1.0, 12.0) : 1.0;
  return style;
}

Colour height_colour(float height, const ReliefStyle& style) {
  const float range = style.high - style.low;
  const float share = range > 0 ? std::clamp((height - style.low) / range, 0.0F, 1.0F) : 0.3F;
  std::size_t i = 1;
  while (i + 1 < kRamp.size() && share > kRamp[i].at) ++i;
  return mixed(kRamp[i - 1].colour, kRamp[i].colour,
               (share - kRamp[i - 1].at) / (kRamp[i].at - kRamp[i - 1].at));
}

Image draw_relief(const TerrainRaster& raster, const View& view, int factor,
                  const ReliefStyle& style, const std::stop_token& stop) {
  Image image(view.width, view.height);
  const double ground = view.ground_per_pixel() / factor;
  const float share = 1.0F / static_cast<float>(factor * factor);
  for (int y = 0; y < view.height; ++y) {
    stop_if_asked(stop, "drawing");
    for (int x = 0; x < view.width; ++x) {
      Colour sum{0, 0, 0};
      for (int k = 0; k < factor * factor; ++k) {
        const Colour c = pixel_colour(raster, x * factor + k % factor, y * factor + k / factor,
                                      ground, factor, style);
        for (std::size_t i = 0; i < 3; ++i) sum[i] += c[i] * share;
      }
      image.put(x, y, sum);
    }
  }
  return image;
}

}  // namespace ptin::tools
