// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "engine/query/questions.h"
#include "engine/stop.h"
#include "tools/plot/axis.h"

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

std::string height_text(float height, float range, const std::string& unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f", range < 10 ? 1 : 0, static_cast<double>(height));
  return std::string(text.data()).append(unit.empty() ? "" : " ").append(unit);
}

/// What the legend says, and how wide it is.
struct Legend {
  std::string length, low, high;  ///< `low` and `high` are empty where colours show no heights.
  double bar = 0.0, ramp = 0.0;   ///< Pixels.
};

constexpr double kPadding = 10, kBetween = 8, kApart = 16, kTop = 6, kLegendHeight = 24;

double width_of(Canvas& canvas, const Legend& legend) {
  const double scale = 2 * kPadding + legend.bar + kBetween + canvas.text_width(legend.length);
  if (legend.low.empty()) return scale;
  return scale + kApart + canvas.text_width(legend.low) + kBetween + legend.ramp + kBetween +
         canvas.text_width(legend.high);
}

void draw_bar(Canvas& canvas, const CanvasBox& box) {
  canvas.box({box.left, box.bottom - 2, box.right, box.bottom}, kInk);
  canvas.box({box.left, box.top, box.left + 1, box.bottom}, kInk);
  canvas.box({box.right - 1, box.top, box.right, box.bottom}, kInk);
}

void draw_ramp(Canvas& canvas, const CanvasBox& box, const ReliefStyle& style) {
  const int columns = static_cast<int>(box.width());
  for (int i = 0; i < columns; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(columns);
    const float height = style.low + (style.high - style.low) * share;
    // A column reaches below the next one, so that none shines through between them.
    const double right = std::min(box.left + i + 2, box.right);
    canvas.box({box.left + i, box.top, right, box.bottom}, height_colour(height, style));
  }
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
      const double opacity = std::clamp(length / 14.0, 0.06, 0.62) * (is_void ? 0.35 : 1.0);
      if (clip_to(canvas, a, b)) canvas.line(a, b, {.opacity = opacity});
    }
  }
}

void draw_legend(Canvas& canvas, const View& view, const ReliefStyle& style,
                 const std::string& length_unit, const std::string& height_unit) {
  constexpr double kBeside = 8, kMostRamp = 90, kLeastRamp = 40;
  const double ground = round_below(view.ground_per_pixel() * canvas.width() * 0.22);
  const ShownUnit lengths = short_unit(length_unit) == "m" && ground >= 1000
                                ? ShownUnit{1000.0, "km"}
                                : ShownUnit{1.0, short_unit(length_unit)};
  Legend legend;
  legend.bar = std::round(ground / view.ground_per_pixel());
  legend.length = lengths.text(ground);
  if (!style.by_page && style.high >= style.low) {
    const float range = style.high - style.low;
    const std::string unit = short_unit(height_unit);
    legend.low = (style.any_below ? "< " : "") + height_text(style.low, range, unit);
    legend.high = (style.any_above ? "> " : "") + height_text(style.high, range, unit);
    const double room = canvas.width() - 2 * kBeside - width_of(canvas, legend);
    legend.ramp = std::clamp(std::floor(room), kLeastRamp, kMostRamp);
  }
  const double width = width_of(canvas, legend);
  if (width + 2 * kBeside > canvas.width() || kLegendHeight + 2 * kBeside > canvas.height()) return;
  const double top = canvas.height() - kLegendHeight - kBeside;
  const double middle = top + kLegendHeight / 2;
  canvas.box({kBeside, top, kBeside + width, top + kLegendHeight}, {255, 255, 255}, 0.8);
  double x = kBeside + kPadding;
  draw_bar(canvas, {x, middle - 4, x + legend.bar, middle + 4});
  x += legend.bar + kBetween;
  canvas.text({x, middle}, legend.length);
  if (legend.low.empty()) return;
  x += canvas.text_width(legend.length) + kApart;
  canvas.text({x, middle}, legend.low);
  x = std::round(x + canvas.text_width(legend.low) + kBetween);
  draw_ramp(canvas, {x, top + kTop, x + legend.ramp, top + kLegendHeight - kTop}, style);
  canvas.text({x + legend.ramp + kBetween, middle}, legend.high);
}

}  // namespace ptin::tools
