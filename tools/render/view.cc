// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/view.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/error.h"

namespace ptin::tools {

namespace {

/// The pixels of a side whose length may be anything, no number too.
int sides_pixels(double length) {
  constexpr int kLeast = 64;
  return length > kLeast && std::isfinite(length) ? static_cast<int>(std::lround(length)) : kLeast;
}

}  // namespace

View make_view(const Window& window, const MapPoint& ground_per_unit, int width, int height) {
  View view;
  view.window = window;
  const double map_width = window.max_x - window.min_x;
  const double map_height = window.max_y - window.min_y;
  if (!(map_width > 0 && map_height > 0) || std::isinf(map_width) || std::isinf(map_height)) {
    throw Error(ErrorCode::invalid_argument,
                "the window to draw has no area; give one with XMIN < XMAX and YMIN < YMAX");
  }
  constexpr double kNarrowest = 0.01;  // at the poles a degree of longitude has no length
  view.ground_y = ground_per_unit.y;
  view.ground_x = std::max(ground_per_unit.x, kNarrowest * ground_per_unit.y);
  const double ground_width = map_width * view.ground_x;
  const double ground_height = map_height * view.ground_y;
  if (width == 0 && height == 0) {
    constexpr double kLongerSide = 1200.0;
    const double longer = std::max(ground_width, ground_height);
    width = sides_pixels(ground_width / longer * kLongerSide);
    height = sides_pixels(ground_height / longer * kLongerSide);
  }
  if (width < 1 || height < 1 || width > kMostPixels || height > kMostPixels) {
    throw Error(ErrorCode::invalid_argument,
                "the picture's sides must be from 1 to " + std::to_string(kMostPixels) + " pixels",
                "--size");
  }
  view.width = width;
  view.height = height;
  const double pixels = std::min(width / ground_width, height / ground_height);
  view.scale_x = pixels * view.ground_x;
  view.scale_y = pixels * view.ground_y;
  const auto is_scale = [](double scale) { return scale > 0 && std::isfinite(scale); };
  if (!is_scale(view.scale_x) || !is_scale(view.scale_y)) {
    throw Error(ErrorCode::invalid_argument,
                "the window to draw is of no size over ground; give one where the CRS has ground");
  }
  view.left = (width - ground_width * pixels) / 2;
  view.top = (height - ground_height * pixels) / 2;
  return view;
}

int pixels_between_samples(const AffineMap& map, const View& view) {
  constexpr double kMost = 12.0;
  const double spacing = std::round(std::max(map.step_x * view.scale_x, map.step_y * view.scale_y));
  return spacing < kMost ? static_cast<int>(std::max(spacing, 1.0)) : static_cast<int>(kMost);
}

View supersampled(const View& view, double factor) {
  View fine = view;
  fine.width = static_cast<int>(std::ceil(view.width * factor));
  fine.height = static_cast<int>(std::ceil(view.height * factor));
  fine.scale_x *= factor;
  fine.scale_y *= factor;
  fine.left *= factor;
  fine.top *= factor;
  return fine;
}

}  // namespace ptin::tools
