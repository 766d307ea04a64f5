// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a picture shows: a window of the map on a rectangle of pixels, with the right aspect.
#pragma once

#include "engine/query/questions.h"

namespace ptin::tools {

/// Most pixels of a picture's side: Cairo has no larger ones.
constexpr int kMostPixels = 32767;

/// Pixel (0, 0) is the upper left one; its centre is at (0.5, 0.5).
struct View {
  Window window{};  ///< Map units; shown whole, centred.
  int width = 0;    ///< Pixels.
  int height = 0;
  double ground_x = 1.0;  ///< Ground units in a map unit; those of heights, if known.
  double ground_y = 1.0;
  double scale_x = 1.0;  ///< Pixels in a map unit.
  double scale_y = 1.0;
  double left = 0.0;  ///< Pixels beside and above the window.
  double top = 0.0;

  [[nodiscard]] double pixel_x(double map_x) const {
    return left + (map_x - window.min_x) * scale_x;
  }
  [[nodiscard]] double pixel_y(double map_y) const {
    return top + (window.max_y - map_y) * scale_y;
  }
  /// Ground units across a pixel; the same in x and y.
  [[nodiscard]] double ground_per_pixel() const { return ground_x / scale_x; }
};

/// A view of `window`. Width and height 0: the longer side has 1200 pixels and the picture the
/// window's own aspect.
/// @param ground_per_unit  Ground units in a map unit along x and y, at the middle of the window.
/// @throws Error invalid_argument  the window has no area, or none over ground that doubles hold;
///                                 one side alone is 0, or one is negative or above kMostPixels
[[nodiscard]] View make_view(const Window& window, const MapPoint& ground_per_unit, int width,
                             int height);

/// The number of pixels between samples that stand on the steps of the grid, 1 to 12.
[[nodiscard]] int pixels_between_samples(const AffineMap& map, const View& view);

/// The same view with `factor` times the pixels in each direction, rounded up.
[[nodiscard]] View supersampled(const View& view, double factor);

}  // namespace ptin::tools
