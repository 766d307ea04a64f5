// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/rasterize.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/query/questions.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

struct Corner {
  double x, y, z;
};

/// The first row or column whose pixel centre is not below `low`; so two of them bound the pixels
/// of a half-open interval.
int first_centre(double low) {
  constexpr double kBeyond = 1e9;  // More pixels than a picture has, and still an int.
  return static_cast<int>(std::ceil((low > -1.0 ? std::min(low, kBeyond) : -1.0) - 0.5));
}

/// The place where the line a -> b is at height y of the picture.
double x_at(const Corner& a, const Corner& b, double y) {
  return a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
}

/// Calls fill(row, begin, end) for each row of pixels: the triangle covers the centres of the
/// columns [begin, end).
template <typename Fill>
void scan(std::array<Corner, 3> c, int width, int height, const Fill& fill) {
  std::sort(c.begin(), c.end(), [](const Corner& a, const Corner& b) { return a.y < b.y; });
  const int begin = std::max(0, first_centre(c[0].y));
  const int end = first_centre(std::min(c[2].y, height + 1.0));
  for (int row = begin; row < std::min(end, height); ++row) {
    const double y = row + 0.5;
    const double across = x_at(c[0], c[2], y);
    const double bent = y < c[1].y ? x_at(c[0], c[1], y) : x_at(c[1], c[2], y);
    const double low = std::min(across, bent);
    const double high = std::min(std::max(across, bent), width + 1.0);
    const int from = std::max(0, first_centre(low));
    const int to = std::min(width, first_centre(high));
    if (from < to) fill(row, from, to);
  }
}

}  // namespace

TerrainRaster rasterize(const RefinedTin& refined, const StoreFacts& facts, const View& view,
                        const std::stop_token& stop) {
  TerrainRaster raster;
  raster.width = view.width;
  raster.height = view.height;
  const std::size_t pixels =
      static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  raster.heights.assign(pixels, 0.0F);
  raster.classes.assign(pixels, PixelClass::kOutside);
  const bool has_pages = refined.page_of_triangle.size() == refined.tin.triangles.size();
  if (has_pages) raster.pages.assign(pixels, kNone);
  const Tin& tin = refined.tin;
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) stop_if_asked(stop, "drawing");
    const bool is_void = tin.classes[t] == TriangleClass::kVoid;
    std::array<Corner, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId v = tin.triangles[t].v[i];
      const MapPoint p = facts.map.to_map(tin.position(v).x, tin.position(v).y);
      corners[i] = {view.pixel_x(p.x), view.pixel_y(p.y),
                    is_void ? 0.0 : facts.heights.height(tin.vertices[v].height)};
    }
    // The plane z = z0 + gx * (x - x0) + gy * (y - y0).
    const auto& [a, b, c] = corners;
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const double gx = ((b.z - a.z) * (c.y - a.y) - (c.z - a.z) * (b.y - a.y)) / area;
    const double gy = ((c.z - a.z) * (b.x - a.x) - (b.z - a.z) * (c.x - a.x)) / area;
    const Corner origin = a;
    scan(corners, view.width, view.height, [&](int row, int from, int to) {
      for (int x = from; x < to; ++x) {
        const std::size_t place = raster.place(x, row);
        raster.classes[place] = is_void ? PixelClass::kVoid : PixelClass::kSurface;
        raster.heights[place] =
            static_cast<float>(origin.z + gx * (x + 0.5 - origin.x) + gy * (row + 0.5 - origin.y));
        if (has_pages) raster.pages[place] = refined.page_of_triangle[t];
      }
    });
  }
  return raster;
}

}  // namespace ptin::tools
