// SPDX-License-Identifier: GPL-3.0-or-later
//
// A picture in memory, and its way into a PNG file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace ptin::tools {

using Colour = std::array<float, 3>;  ///< Red, green, blue, 0 to 255.

/// `share` of `to`, the rest of `from`.
[[nodiscard]] inline Colour mixed(const Colour& from, const Colour& to, float share) {
  Colour made{};
  for (std::size_t i = 0; i < 3; ++i) made[i] = from[i] + share * (to[i] - from[i]);
  return made;
}

/// Row-major, from the upper left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Colour> pixels;

  Image(int w, int h, const Colour& colour)
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), colour) {}
  [[nodiscard]] bool holds(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height;
  }
  [[nodiscard]] Colour& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// Writes `image` as PNG, whole or not at all.
/// @throws Error  as OutputFile; io_error when GDAL has no PNG driver
void write_png(const Image& image, const std::string& path, bool overwrite);

}  // namespace ptin::tools
