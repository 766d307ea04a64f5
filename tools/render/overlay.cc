// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "engine/query/terrain.h"
#include "engine/stop.h"

namespace ptin::tools {

namespace {

constexpr Colour kInk{24, 26, 34};

void blend(Image& image, int x, int y, const Colour& colour, double opacity) {
  if (!image.holds(x, y)) return;
  image.at(x, y) = mixed(image.at(x, y), colour, static_cast<float>(opacity));
}

/// Cuts a line to the part that may be seen, so that far ends cost nothing. False when nothing is
/// left.
bool clip_to(const Image& image, double& x0, double& y0, double& x1, double& y1) {
  double enter = 0.0;
  double leave = 1.0;
  const double dx = x1 - x0;
  const double dy = y1 - y0;
  const std::array<std::array<double, 2>, 4> sides = {
      {{-dx, x0 + 1}, {dx, image.width + 1 - x0}, {-dy, y0 + 1}, {dy, image.height + 1 - y0}}};
  for (const auto& [p, q] : sides) {
    if (p == 0 && q < 0) return false;
    if (p < 0) enter = std::max(enter, q / p);
    if (p > 0) leave = std::min(leave, q / p);
  }
  if (enter >= leave) return false;
  x1 = x0 + leave * dx;
  y1 = y0 + leave * dy;
  x0 += enter * dx;
  y0 += enter * dy;
  return true;
}

/// Glyphs of 5 x 7 pixels: a number for each row, whose bits are pixels from left to right. No more
/// letters than a legend needs.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 7> rows;
};
constexpr std::array<Glyph, 21> kGlyphs = {
    {{'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
     {'2', {14, 17, 1, 2, 4, 8, 31}},     {'3', {31, 2, 4, 2, 1, 17, 14}},
     {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
     {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
     {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},
     {'.', {0, 0, 0, 0, 0, 12, 12}},      {'-', {0, 0, 0, 31, 0, 0, 0}},
     {'+', {0, 4, 4, 31, 4, 4, 0}},       {'/', {1, 1, 2, 4, 8, 16, 16}},
     {'<', {1, 2, 4, 8, 4, 2, 1}},        {'>', {16, 8, 4, 2, 4, 8, 16}},
     {'e', {0, 0, 14, 17, 31, 16, 14}},   {'k', {16, 16, 18, 20, 24, 20, 18}},
     {'m', {0, 0, 26, 21, 21, 17, 17}},   {'f', {6, 9, 8, 28, 8, 8, 8}},
     {'t', {8, 8, 28, 8, 8, 9, 6}}}};

constexpr int kLetterWidth = 6;
constexpr int kLetterHeight = 7;

}  // namespace

void draw_text(Image& image, int x, int y, std::string_view text) {
  for (const char letter : text) {
    for (const Glyph& glyph : kGlyphs) {
      if (glyph.letter != letter) continue;
      for (int row = 0; row < kLetterHeight; ++row) {
        for (int column = 0; column < 5; ++column) {
          if ((glyph.rows[static_cast<std::size_t>(row)] >> (4 - column) & 1) != 0) {
            blend(image, x + column, y + row, kInk, 1.0);
          }
        }
      }
    }
    x += letter == ' ' ? 4 : kLetterWidth;
  }
}

int text_width(std::string_view text) {
  int width = 0;
  for (const char letter : text) width += letter == ' ' ? 4 : kLetterWidth;
  return width;
}

namespace {

/// The largest of 1, 2, 5, 10 ... that is not above `value`.
double round_below(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= value) return step * decade;
  }
  return decade;
}

std::string length_text(double length, const std::string& unit) {
  char text[32];
  const bool kilo = unit == "m" && length >= 1000;
  std::snprintf(text, sizeof text, "%g", kilo ? length / 1000 : length);
  return std::string(text).append(unit.empty() ? "" : (kilo ? " km" : " " + unit));
}

std::string height_text(float height, float range, const std::string& unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", range < 10 ? 1 : 0, static_cast<double>(height));
  return std::string(text).append(unit.empty() ? "" : " ").append(unit);
}

void fill(Image& image, int x0, int y0, int x1, int y1, const Colour& colour, double opacity) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) blend(image, x, y, colour, opacity);
  }
}

}  // namespace

void draw_line(Image& image, double x0, double y0, double x1, double y1, const Colour& colour,
               double opacity) {
  if (!clip_to(image, x0, y0, x1, y1)) return;
  const bool steep = std::abs(y1 - y0) > std::abs(x1 - x0);
  if (steep) {
    std::swap(x0, y0);
    std::swap(x1, y1);
  }
  if (x0 > x1) {
    std::swap(x0, x1);
    std::swap(y0, y1);
  }
  const double gradient = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0.0;
  const int first = static_cast<int>(std::floor(x0));
  const int last = static_cast<int>(std::floor(x1));
  for (int x = first; x <= last; ++x) {
    const double covered = std::min(x1, x + 1.0) - std::max(x0, static_cast<double>(x));
    const double y = y0 + gradient * (x + 0.5 - x0) - 0.5;
    const int below = static_cast<int>(std::floor(y));
    const double rest = y - below;
    const double strength = opacity * std::clamp(covered, 0.0, 1.0);
    steep ? blend(image, below, x, colour, strength * (1 - rest))
          : blend(image, x, below, colour, strength * (1 - rest));
    steep ? blend(image, below + 1, x, colour, strength * rest)
          : blend(image, x, below + 1, colour, strength * rest);
  }
}

void draw_wireframe(Image& image, const RefinedTin& refined, const StoreFacts& facts,
                    const View& view, const std::stop_token& stop) {
  const Tin& tin = refined.tin;
  const auto pixel = [&](VertexId v) {
    const MapPoint p = facts.map.to_map(tin.position(v).x, tin.position(v).y);
    return std::array<double, 2>{view.pixel_x(p.x), view.pixel_y(p.y)};
  };
  for (TriangleId t = 0; t < tin.triangles.size(); ++t) {
    if (t % kStopInterval == 0) stop_if_asked(stop, "drawing");
    for (int i = 0; i < 3; ++i) {
      const TriangleId other = tin.triangles[t].n[i];
      if (other != kNone && other < t) continue;
      const bool is_void = tin.classes[t] == TriangleClass::kVoid &&
                           (other == kNone || tin.classes[other] == TriangleClass::kVoid);
      const auto a = pixel(tin.triangles[t].v[next_corner(i)]);
      const auto b = pixel(tin.triangles[t].v[previous_corner(i)]);
      const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
      const double opacity = std::clamp(length / 14.0, 0.06, 0.62) * (is_void ? 0.35 : 1.0);
      draw_line(image, a[0], a[1], b[0], b[1], kInk, opacity);
    }
  }
}

void draw_legend(Image& image, const View& view, const ReliefStyle& style,
                 const std::string& length_unit, const std::string& height_unit) {
  const double ground = round_below(view.ground_per_pixel() * image.width * 0.22);
  const int bar = static_cast<int>(std::lround(ground / view.ground_per_pixel()));
  const std::string length = length_text(ground, length_unit);
  const std::string low =
      (style.any_below ? "<" : "") + height_text(style.low, style.high - style.low, height_unit);
  const std::string high =
      (style.any_above ? ">" : "") + height_text(style.high, style.high - style.low, height_unit);
  const bool has_ramp = !style.by_page && style.high > style.low;
  const int texts = has_ramp ? 24 + text_width(low) + 8 + text_width(high) : 0;
  const int beside_ramp = 10 + bar + 8 + text_width(length) + texts + 10;
  constexpr int kMostRamp = 90, kLeastRamp = 40;
  const int ramp = has_ramp ? std::clamp(image.width - 16 - beside_ramp, kLeastRamp, kMostRamp) : 0;
  const int width = beside_ramp + ramp;
  constexpr int kHeight = 21;
  if (width + 16 > image.width || kHeight + 16 > image.height) return;
  const int left = 8;
  const int top = image.height - kHeight - 8;
  fill(image, left, top, left + width, top + kHeight, {255, 255, 255}, 0.78);
  int x = left + 10;
  const int base = top + 14;
  fill(image, x, base - 1, x + bar, base + 1, kInk, 1.0);
  fill(image, x, base - 6, x + 1, base + 1, kInk, 1.0);
  fill(image, x + bar - 1, base - 6, x + bar, base + 1, kInk, 1.0);
  x += bar + 8;
  draw_text(image, x, top + 7, length);
  if (!has_ramp) return;
  x += text_width(length) + 16;
  draw_text(image, x, top + 7, low);
  x += text_width(low) + 4;
  for (int i = 0; i < ramp; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(ramp);
    const float height = style.low + (style.high - style.low) * share;
    fill(image, x + i, top + 6, x + i + 1, top + 15, height_colour(height, style), 1.0);
  }
  draw_text(image, x + ramp + 4, top + 7, high);
}

}  // namespace ptin::tools
