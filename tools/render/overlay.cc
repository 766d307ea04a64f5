// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/query/questions.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

/// Cuts a line to the part that may be seen: its ends may be farther away than Cairo's coordinates
/// reach. False when nothing is left.
bool clip_to(const Canvas& canvas, CanvasPoint& a, CanvasPoint& b) {
  double enter = 0.0;
  double leave = 1.0;
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const std::array<std::array<double, 2>, 4> sides = {{{-dx, a.x + 1},
                                                       {dx, canvas.width() + 1 - a.x},
                                                       {-dy, a.y + 1},
                                                       {dy, canvas.height() + 1 - a.y}}};
  for (const auto& [p, q] : sides) {
    if (p == 0 && q < 0) return false;
    if (p < 0) enter = std::max(enter, q / p);
    if (p > 0) leave = std::min(leave, q / p);
  }
  if (enter >= leave) return false;
  b = {a.x + leave * dx, a.y + leave * dy};
  a = {a.x + enter * dx, a.y + enter * dy};
  return true;
}

}  // namespace

void draw_wireframe(Canvas& canvas, const RefinedTin& refined, const StoreFacts& facts,
                    const View& view, const std::stop_token& stop) {
  const Tin& tin = refined.tin;
  const auto pixel = [&](VertexId v) {
    const MapPoint p = facts.map.to_map(tin.position(v).x, tin.position(v).y);
    return CanvasPoint{view.pixel_x(p.x), view.pixel_y(p.y)};
  };
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) stop_if_asked(stop, "drawing");
    for (int i = 0; i < 3; ++i) {
      const TriangleId other = tin.triangles[t].n[i];
      if (other != kNone && other < t) continue;
      const bool is_void = tin.classes[t] == TriangleClass::kVoid &&
                           (other == kNone || tin.classes[other] == TriangleClass::kVoid);
      CanvasPoint a = pixel(tin.triangles[t].v[next_corner(i)]);
      CanvasPoint b = pixel(tin.triangles[t].v[previous_corner(i)]);
      const double length = std::hypot(b.x - a.x, b.y - a.y);
      // Triangles of sides L have 3.5 / L of edges in a unit of area: lines of one pixel in this opacity
      // cover a quarter of the ground, however dense they are.
      constexpr double kOpaqueAt = 14.0, kDarkest = 0.62, kUnseen = 0.002;
      const double opacity = std::min(length / kOpaqueAt, kDarkest) * (is_void ? 0.35 : 1.0);
      if (opacity < kUnseen) continue;
      if (clip_to(canvas, a, b)) canvas.line(a, b, {.opacity = opacity});
    }
  }
}

}  // namespace ptin::tools
