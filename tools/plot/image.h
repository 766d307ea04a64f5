// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture in memory, of pixels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace ptin::tools {

using Colour = std::array<float, 3>;  ///< Red, green, blue, 0 to 255.

/// `share` of `to`, the rest of `from`.
[[nodiscard]] inline Colour mixed(const Colour& from, const Colour& to, float share) {
  Colour made{};
  for (std::size_t i = 0; i < 3; ++i) made[i] = from[i] + share * (to[i] - from[i]);
  return made;
}

/// Row-major, from the upper left. A pixel holds red, green and blue in 8 bits each, blue lowest.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> pixels;

  Image(int w, int h)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0xffffff) {}

  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] Colour at(int x, int y) const {
    const std::uint32_t pixel = pixels[place(x, y)];
    return {static_cast<float>(pixel >> 16 & 255), static_cast<float>(pixel >> 8 & 255),
            static_cast<float>(pixel & 255)};
  }
  void put(int x, int y, const Colour& colour) {
    std::uint32_t pixel = 0;
    for (const float share : colour) {
      pixel = pixel << 8 | static_cast<std::uint32_t>(std::lround(std::clamp(share, 0.0F, 255.0F)));
    }
    pixels[place(x, y)] = pixel;
  }
};

}  // namespace ptin::tools
