// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tools/facts/human.h"
#include "tools/plot/axis.h"

namespace ptin::tools {

namespace {

// Pixels beside the map. The lower margin has the coordinates, the legend, and a line of the foot each.
constexpr double kLeftOfMap = 30, kRightOfMap = 16, kAboveMap = 16, kTitleAbove = 24;
constexpr double kCoordinates = 20, kLegendBelow = 40, kFootLine = 15, kBelowFoot = 7;
constexpr int kLeastMap = 240;  // a smaller map is worth more than what stands around it
constexpr double kFootSize = 10.5, kTickSize = 10.5, kTickLength = 5;
constexpr Colour kFaintInk{88, 92, 102};

/// The lines of the foot on a sheet of this width. No sheet is drawn on yet, so the letters are taken to
/// be as wide as they are on average.
std::vector<std::string> foot_lines(const std::string& foot, double width) {
  constexpr double kLetter = 0.58 * kFootSize;
  const double room = width - kLeftOfMap - kRightOfMap;
  return wrapped(foot, static_cast<std::size_t>(std::max(room / kLetter, 1.0)));
}

/// What stands around a map on a sheet of this width: the box has the margins.
CanvasBox margins_of(const SheetText& text, std::size_t foot) {
  return {kLeftOfMap, kAboveMap + (text.title.empty() ? 0 : kTitleAbove), kRightOfMap,
          kCoordinates + kLegendBelow + kFootLine * static_cast<double>(foot) + kBelowFoot};
}

/// A longitude or latitude with the letter of its half of the Earth.
std::string degrees_text(double value, double step, bool is_latitude) {
  std::string text = tick_text(std::abs(value), step) + "\u00b0";
  if (std::abs(value) < step / 2) return text;
  if (is_latitude) return text + (value > 0 ? " N" : " S");
  return text + (value > 0 ? " E" : " W");
}

void draw_frame_of(Canvas& canvas, const CanvasBox& a) {
  canvas.line(std::array<CanvasPoint, 5>{{{a.left, a.top},
                                          {a.right, a.top},
                                          {a.right, a.bottom},
                                          {a.left, a.bottom},
                                          {a.left, a.top}}},
              {});
}

/// Ticks along one side and its opposite; the text stands beside the first one.
class FrameTicks {
 public:
  FrameTicks(Canvas& canvas, const CanvasBox& map, const View& view, const SheetText& text)
      : canvas_(canvas), map_(map), view_(view), text_(text) {}

  void draw_across() const {
    const Window& w = view_.window;
    const auto x_at = [&](double pixel) { return w.min_x + (pixel - view_.left) / view_.scale_x; };
    const Ticks ticks = round_ticks(x_at(0), x_at(view_.width), most(view_.width));
    double free_from = 0;
    for (const double tick : ticks.at) {
      const double x = map_.left + view_.pixel_x(tick);
      mark({x, map_.bottom}, {x, map_.bottom + kTickLength});
      mark({x, map_.top}, {x, map_.top - kTickLength});
      const std::string label = label_of(tick, ticks.step, false);
      const double half = canvas_.text_width(label, kStyle) / 2;
      // A text stays below the map: in the corner it would meet that of the other side.
      const double middle = std::clamp(x, map_.left + half, map_.right - half);
      if (middle - half < free_from) continue;
      canvas_.text({middle, map_.bottom + kTickLength + 8}, label, kStyle);
      free_from = middle + half + kApart;
    }
  }

  void draw_up() const {
    const Window& w = view_.window;
    const auto y_at = [&](double pixel) { return w.max_y + (view_.top - pixel) / view_.scale_y; };
    const Ticks ticks = round_ticks(y_at(view_.height), y_at(0), most(view_.height));
    double free_below = canvas_.height();
    for (const double tick : ticks.at) {
      const double y = map_.top + view_.pixel_y(tick);
      mark({map_.left, y}, {map_.left - kTickLength, y});
      mark({map_.right, y}, {map_.right + kTickLength, y});
      const std::string label = label_of(tick, ticks.step, true);
      const double half = canvas_.text_width(label, kStyle) / 2;
      const double middle = std::clamp(y, map_.top + half, map_.bottom - half);
      if (middle + half > free_below) continue;
      TextStyle style = kStyle;
      style.turn = kReadFromBelow;
      canvas_.text({map_.left - kTickLength - 10, middle}, label, style);
      free_below = middle - half - kApart;
    }
  }

 private:
  static constexpr TextStyle kStyle{.anchor = TextAnchor::kMiddle, .size = kTickSize};
  static constexpr double kApart = 14;

  /// So many ticks that their texts have room.
  [[nodiscard]] static int most(int pixels) { return std::max(4, pixels / 80); }
  void mark(CanvasPoint from, CanvasPoint to) const { canvas_.line(from, to, {}); }
  [[nodiscard]] std::string label_of(double tick, double step, bool is_up) const {
    return text_.is_in_degrees ? degrees_text(tick, step, is_up) : tick_text(tick, step);
  }

  Canvas& canvas_;
  const CanvasBox& map_;
  const View& view_;
  const SheetText& text_;
};

/// Draws the bar from `left`; returns where it and its text end.
double draw_scale_bar(Canvas& canvas, CanvasPoint left, const View& view,
                      const std::string& length_unit) {
  constexpr double kShare = 0.2;  // of the map's width, at most
  const double ground = round_below(view.ground_per_pixel() * view.width * kShare);
  const ShownUnit lengths = short_unit(length_unit) == "m" && ground >= 1000
                                ? ShownUnit{1000.0, "km"}
                                : ShownUnit{1.0, short_unit(length_unit)};
  const double bar = std::round(ground / view.ground_per_pixel());
  const double right = left.x + bar;
  canvas.box({left.x, left.y + 2, right, left.y + 4}, kInk);
  canvas.box({left.x, left.y - 4, left.x + 1, left.y + 4}, kInk);
  canvas.box({right - 1, left.y - 4, right, left.y + 4}, kInk);
  const std::string text = lengths.text(ground);
  canvas.text({right + 7, left.y}, text, {.size = kTickSize});
  return right + 7 + canvas.text_width(text, {.size = kTickSize});
}

/// A small box of what something looks like, and its name. Returns where it ends.
double draw_swatch(Canvas& canvas, CanvasPoint left, const std::string& name, bool is_void) {
  const CanvasBox box{left.x, left.y - 6, left.x + 18, left.y + 6};
  canvas.box(box, is_void ? kVoidColour : kWaterColour);
  if (is_void) canvas.hatch(box, {kHatchColour});
  canvas.text({box.right + 6, left.y}, name, {.size = kTickSize});
  return box.right + 6 + canvas.text_width(name, {.size = kTickSize});
}

/// The colours of heights from `left` to `right`. An end beyond which there are heights is pointed.
void draw_colours(Canvas& canvas, const CanvasBox& box, const ReliefStyle& style) {
  const int columns = static_cast<int>(box.width());
  for (int i = 0; i < columns; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(columns);
    const float height = style.low + (style.high - style.low) * share;
    // A column reaches below the next one, so that none shines through between them.
    const double right = std::min(box.left + i + 2, box.right);
    canvas.box({box.left + i, box.top, right, box.bottom}, height_colour(height, style));
  }
  // The outline goes around the points, whose colours may be as pale as the sheet.
  const double middle = (box.top + box.bottom) / 2, point = box.height();
  const CanvasPoint low{box.left - (style.any_below ? point : 0), middle};
  const CanvasPoint high{box.right + (style.any_above ? point : 0), middle};
  canvas.polygon(std::array<CanvasPoint, 3>{{low, {box.left, box.top}, {box.left, box.bottom}}},
                 height_colour(style.low, style));
  canvas.polygon(std::array<CanvasPoint, 3>{{high, {box.right, box.top}, {box.right, box.bottom}}},
                 height_colour(style.high, style));
  canvas.line(std::array<CanvasPoint, 7>{{low,
                                          {box.left, box.top},
                                          {box.right, box.top},
                                          high,
                                          {box.right, box.bottom},
                                          {box.left, box.bottom},
                                          low}},
              {kFaintInk, 0.7});
}

/// The colours with ticks at round heights, their right end at `right`.
void draw_ramp(Canvas& canvas, double left, CanvasPoint right, const ReliefStyle& style,
               const std::string& height_unit) {
  constexpr double kMostRamp = 260, kLeastRamp = 60, kRampHeight = 10, kTickRoom = 46;
  const std::string unit = short_unit(height_unit);
  const double beside = unit.empty() ? 0 : canvas.text_width(unit, {.size = kTickSize}) + 16;
  // The pointed ends, and half of a number beyond them.
  const double room = right.x - left - beside - 2 * kRampHeight - kTickRoom / 2;
  if (room < kLeastRamp || style.low > style.high) return;
  const double width = std::floor(std::min(room, kMostRamp));
  const double end = std::floor(right.x - beside - kRampHeight);
  const CanvasBox box{end - width, right.y - kRampHeight / 2 - 4, end,
                      right.y + kRampHeight / 2 - 4};
  draw_colours(canvas, box, style);
  if (!unit.empty()) {
    canvas.text({right.x, right.y - 4}, unit, {.anchor = TextAnchor::kEnd, .size = kTickSize});
  }
  const Ticks ticks = round_ticks(static_cast<double>(style.low), static_cast<double>(style.high),
                                  std::max(2, static_cast<int>(width / kTickRoom)));
  const double range = static_cast<double>(style.high) - static_cast<double>(style.low);
  for (const double tick : ticks.at) {
    const double share = range > 0 ? (tick - static_cast<double>(style.low)) / range : 0.5;
    const double x = box.left + share * width;
    canvas.line({x, box.bottom}, {x, box.bottom + 4}, {});
    canvas.text({x, box.bottom + 12}, tick_text(tick, ticks.step),
                {.anchor = TextAnchor::kMiddle, .size = kTickSize});
  }
}

void draw_legend_row(Canvas& canvas, const SheetLayout& layout, const View& view,
                     const ReliefStyle& style, const SheetText& text) {
  constexpr double kApart = 24;
  const double y = layout.map.bottom + kCoordinates + kLegendBelow / 2;
  double x = draw_scale_bar(canvas, {layout.map.left, y}, view, text.length_unit) + kApart;
  if (style.any_water) x = draw_swatch(canvas, {x, y}, "water", false) + kApart;
  if (style.any_void) x = draw_swatch(canvas, {x, y}, "void", true) + kApart;
  if (!style.by_page) draw_ramp(canvas, x, {layout.map.right, y}, style, text.height_unit);
}

/// An arrow to the north in the upper right corner of the map.
void draw_north(Canvas& canvas, const CanvasBox& map, double north) {
  constexpr double kLength = 20, kHalf = 6, kFromCorner = 30;
  const CanvasPoint middle{map.right - kFromCorner, map.top + kFromCorner};
  canvas.box({middle.x - 24, middle.y - 24, middle.x + 24, middle.y + 24}, {255, 255, 255}, 0.75);
  const double sin = std::sin(north), cos = std::cos(north);
  const auto at = [&](double right, double up) {
    return CanvasPoint{middle.x + right * cos + up * sin, middle.y + right * sin - up * cos};
  };
  canvas.polygon(std::array<CanvasPoint, 4>{{at(0, kLength / 2 + 1), at(kHalf, -kLength / 2),
                                             at(0, -kLength / 4), at(-kHalf, -kLength / 2)}},
                 kInk);
  canvas.text(at(0, kLength / 2 + 8), "N",
              {.anchor = TextAnchor::kMiddle, .size = 11, .is_bold = true});
}

void draw_title(Canvas& canvas, const CanvasBox& map, const SheetText& text) {
  const double y = map.top - kTitleAbove / 2 - 8;
  const TextStyle style{.anchor = TextAnchor::kEnd, .size = 12, .colour = kFaintInk};
  const double room = map.right - map.left - canvas.text_width(text.detail, style) - 20;
  canvas.clip({map.left, 0, map.left + std::max(room, 0.0), map.top});
  // A long title becomes smaller before it is cut.
  constexpr double kLargest = 16, kSmallest = 11;
  const double width = canvas.text_width(text.title, {.size = kLargest, .is_bold = true});
  const double size = std::clamp(kLargest * room / std::max(width, 1.0), kSmallest, kLargest);
  canvas.text({map.left, y}, text.title, {.size = size, .is_bold = true});
  canvas.unclip();
  canvas.text({map.right, y}, text.detail, style);
}

std::optional<SheetLayout> layout_with(int width, int height, std::vector<std::string> foot,
                                       const CanvasBox& margins) {
  SheetLayout layout{width, height, {}, std::move(foot)};
  layout.map = {margins.left, margins.top, width - margins.right, height - margins.bottom};
  if (layout.map.width() < kLeastMap || layout.map.height() < kLeastMap) return std::nullopt;
  return layout;
}

}  // namespace

std::optional<SheetLayout> layout_within(int width, int height, const SheetText& text) {
  std::vector<std::string> foot = foot_lines(text.foot, width);
  const CanvasBox margins = margins_of(text, foot.size());
  return layout_with(width, height, std::move(foot), margins);
}

SheetLayout with_frame(SheetLayout layout, double width, double height) {
  CanvasBox& map = layout.map;
  map.left += std::floor((map.width() - width) / 2);
  map.top += std::floor((map.height() - height) / 2);
  map.right = map.left + width;
  map.bottom = map.top + height;
  return layout;
}

std::optional<SheetLayout> layout_around(int map_width, int map_height, const SheetText& text) {
  const int width = map_width + static_cast<int>(kLeftOfMap + kRightOfMap);
  std::vector<std::string> foot = foot_lines(text.foot, width);
  const CanvasBox margins = margins_of(text, foot.size());
  const int height = map_height + static_cast<int>(margins.top + margins.bottom);
  return layout_with(width, height, std::move(foot), margins);
}

void draw_sheet(Canvas& canvas, const SheetLayout& layout, const View& view,
                const ReliefStyle& style, const SheetText& text) {
  const CanvasBox& map = layout.map;
  draw_frame_of(canvas, map);
  const FrameTicks ticks(canvas, map, view, text);
  ticks.draw_across();
  ticks.draw_up();
  if (!text.title.empty()) draw_title(canvas, map, text);
  draw_legend_row(canvas, layout, view, style, text);
  double y = map.bottom + kCoordinates + kLegendBelow + kFootLine / 2;
  for (const std::string& line : layout.foot) {
    canvas.text({map.left, y}, line, {.size = kFootSize, .colour = kFaintInk});
    y += kFootLine;
  }
  // North within half a degree of up is what everybody expects.
  constexpr double kHalfDegree = 0.00873;
  if (text.north && std::abs(*text.north) > kHalfDegree) draw_north(canvas, map, *text.north);
}

}  // namespace ptin::tools
