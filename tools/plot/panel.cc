// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/error.h"
#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr int kSheetWidth = 1200, kPanelHeight = 370, kLegendHeight = 36;  // pixels
constexpr double kLeft = 84, kRight = 28, kAbove = 34, kBelow = 52;        // beside a panel's area
constexpr Colour kGround{224, 208, 176}, kGroundLine{118, 70, 34};
constexpr Colour kBand{222, 130, 40}, kVoid{120, 122, 132}, kGrid{206, 208, 214};
constexpr double kBandOpacity = 0.35;
constexpr double kStationRadius = 2.4;
constexpr double kBeyond =
    0.12;  // of the heights' range, above and below: for the ground, and for words
const Stroke kHatch{kVoid, 1.0, 0.8};

/// The first, lowest, highest and last of the points in each half of a pixel's column.
std::vector<CanvasPoint> thinned(std::vector<CanvasPoint> points) {
  std::vector<CanvasPoint> kept;
  const auto column_of = [](const CanvasPoint& p) { return std::floor(2 * p.x); };
  for (auto begin = points.begin(); begin != points.end();) {
    const auto end = std::find_if(begin, points.end(), [&](const CanvasPoint& p) {
      return column_of(p) != column_of(*begin);
    });
    const auto [low, high] = std::minmax_element(
        begin, end, [](const CanvasPoint& a, const CanvasPoint& b) { return a.y < b.y; });
    std::array chosen = {begin, std::min(low, high), std::max(low, high), end - 1};
    for (auto last = std::unique(chosen.begin(), chosen.end());
         const auto& p : std::span(chosen.begin(), last))
      kept.push_back(*p);
    begin = end;
  }
  return kept;
}

std::vector<CanvasPoint> moved(std::vector<CanvasPoint> points, double down) {
  for (CanvasPoint& p : points) p.y += down;
  return points;
}

}  // namespace

PanelScales::PanelScales(const PlotUnits& units, double longest, double lowest, double highest)
    : length(longest > 0 ? longest : 1.0), lengths(shown_unit(units.length, length)) {
  heights = {1.0, short_unit(units.height)};
  if (!(lowest <= highest)) return;
  // Level ground is drawn level, and not what rounding makes of it: at most kMostExaggeration times
  // steeper than it is, and in numbers that are not longer than five digits and a sign.
  constexpr double kMostExaggeration = 40.0;
  constexpr double kAspect = (kPanelHeight - kAbove - kBelow) / (kSheetWidth - kLeft - kRight);
  const double largest = std::max(std::abs(lowest), std::abs(highest));
  const double flattest = kAspect / (kMostExaggeration * (1 + 2 * kBeyond)) * length;
  const double least = std::max({1e-6, 1e-4 * largest, flattest * units.heights_per_length});
  const double range = std::max(highest - lowest, least);
  const double middle = (lowest + highest) / 2;
  low = std::min(lowest, middle - range / 2) - kBeyond * range;
  high = std::max(highest, middle + range / 2) + kBeyond * range;
}

void require_panels(std::size_t count, const std::string& things, const std::string& path) {
  if (count <= kMostPanels) return;
  throw Error(ErrorCode::invalid_argument,
              "a picture has room for " + std::to_string(kMostPanels) + " " + things +
                  ", and these are " + grouped(count) + "; give fewer, or write .csv or a layer",
              path);
}

LegendEntry line_entry(const Stroke& stroke, std::string text) {
  return {[stroke](Canvas& canvas, const CanvasBox& box) {
            const double middle = (box.top + box.bottom) / 2;
            canvas.line({box.left, middle}, {box.right, middle}, stroke);
          },
          std::move(text)};
}

LegendEntry void_entry() {
  return {[](Canvas& canvas, const CanvasBox& box) { canvas.hatch(box, kHatch); },
          "void: no height is known"};
}

LegendEntry station_entry() {
  return {
      [](Canvas& canvas, const CanvasBox& box) {
        canvas.dot({(box.left + box.right) / 2, (box.top + box.bottom) / 2}, kStationRadius, kInk);
      },
      "station"};
}

LegendEntry deviation_entry(double deviation, const ShownUnit& heights) {
  return {[](Canvas& canvas, const CanvasBox& box) {
            canvas.box(box, kBand, kBandOpacity);
            const double middle = (box.top + box.bottom) / 2;
            canvas.line({box.left, middle}, {box.right, middle}, {kGroundLine, 1.4});
          },
          "ground, certainly within " + heights.text(deviation)};
}

std::string exaggeration_text(const PanelScales& scales, const PlotUnits& units) {
  const double pixels_per_height = (kPanelHeight - kAbove - kBelow) / (scales.high - scales.low);
  const double pixels_per_length = (kSheetWidth - kLeft - kRight) / scales.length;
  const double factor = pixels_per_height / pixels_per_length * units.heights_per_length;
  const double digit = std::pow(10.0, std::floor(std::log10(factor)) - 1);  // the second
  return "heights " + short_number(std::round(factor / digit) * digit) +
         (factor < 1 ? " of their true scale" : " times exaggerated");
}

Canvas sheet_for(std::size_t panels, const std::string& path, bool overwrite) {
  return {path, overwrite, kSheetWidth, static_cast<int>(panels) * kPanelHeight + kLegendHeight};
}

void draw_sheet_legend(Canvas& canvas, std::span<const LegendEntry> entries) {
  constexpr double kSign = 26, kBetween = 8, kApart = 30;
  double width = -kApart;
  for (const LegendEntry& entry : entries) {
    width += (entry.draw ? kSign + kBetween : 0) + canvas.text_width(entry.text) + kApart;
  }
  // Entries that do not fit beside each other become smaller.
  const double scale = std::min(1.0, (kSheetWidth - kLeft - kRight) / std::max(width, 1.0));
  const TextStyle style{.size = scale * TextStyle{}.size};
  const double y = canvas.height() - kLegendHeight / 2.0 - 4;
  double x = kLeft;
  for (const LegendEntry& entry : entries) {
    if (entry.draw) {
      entry.draw(canvas, {x, y - 7, x + scale * kSign, y + 7});
      x += scale * (kSign + kBetween);
    }
    canvas.text({x, y}, entry.text, style);
    x += canvas.text_width(entry.text, style) + scale * kApart;
  }
}

Panel::Panel(Canvas& canvas, std::size_t number, const PanelScales& scales)
    : canvas_(canvas), scales_(scales) {
  const double top = static_cast<double>(number) * kPanelHeight;
  area_ = {kLeft, top + kAbove, kSheetWidth - kRight, top + kPanelHeight - kBelow};
}

CanvasPoint Panel::at(double distance, double height) const {
  const double up = (height - scales_.low) / (scales_.high - scales_.low);
  return {area_.left + area_.width() * distance / scales_.length,
          area_.bottom - area_.height() * up};
}

void Panel::draw_title(const std::string& title, const std::string& facts) {
  const double y = area_.top - 15;
  constexpr TextStyle kFacts{TextAnchor::kEnd};
  const double room = area_.width() - canvas_.text_width(facts, kFacts) - 20;
  canvas_.clip({area_.left, y - 15, area_.left + std::max(room, 0.0), y + 15});
  canvas_.text({area_.left, y}, title, {.size = 14, .is_bold = true});
  canvas_.unclip();
  canvas_.text({area_.right, y}, facts, kFacts);
}

void Panel::draw_ground(std::span<const ProfilePoint> line, double deviation) {
  constexpr double kUnseen = 0.5;  // pixels between voids
  std::vector<CanvasBox> voids;
  canvas_.clip(area_);
  for (std::size_t begin = 0, end = 1; begin + 1 < line.size(); begin = end) {
    const PointState state = line[begin].state;
    end = begin + 1;
    while (end + 1 < line.size() && line[end].state == state) ++end;
    if (state == PointState::kVoid) {
      const CanvasBox band{at(line[begin].distance, 0).x, area_.top, at(line[end].distance, 0).x,
                           area_.bottom};
      const bool goes_on = !voids.empty() && band.left - voids.back().right < kUnseen;
      goes_on ? void(voids.back().right = band.right) : voids.push_back(band);
    }
    if (state == PointState::kSurface) {
      draw_surface(line.subspan(begin, end - begin + 1), deviation);
    }
  }
  for (const CanvasBox& band : voids) draw_void(band);
  canvas_.unclip();
}

void Panel::draw_surface(std::span<const ProfilePoint> stretch, double deviation) {
  std::vector<CanvasPoint> ground;
  for (const ProfilePoint& p : stretch) {
    if (std::isfinite(p.height)) ground.push_back(at(p.distance, p.height));
  }
  if (ground.empty()) return;
  ground = thinned(std::move(ground));
  std::vector<CanvasPoint> filled = ground;
  filled.push_back({ground.back().x, area_.bottom});
  filled.push_back({ground.front().x, area_.bottom});
  canvas_.polygon(filled, kGround);
  if (deviation > 0) {
    const double pixels = std::min(deviation / (scales_.high - scales_.low), 1.0) * area_.height();
    std::vector<CanvasPoint> band = moved(ground, -pixels);
    const std::vector<CanvasPoint> lower = moved(ground, pixels);
    band.insert(band.end(), lower.rbegin(), lower.rend());
    canvas_.polygon(band, kBand, kBandOpacity);
  }
  canvas_.line(ground, {kGroundLine, 1.4});
}

void Panel::draw_void(const CanvasBox& band) {
  canvas_.hatch(band, kHatch);
  const std::string name = "void";
  if (band.width() < canvas_.text_width(name) + 20) return;
  draw_words({(band.left + band.right) / 2, (band.top + band.bottom) / 2}, name);
}

void Panel::draw_stations(std::span<const ProfilePoint> line) {
  constexpr double kClosest = 5.0;  // pixels; closer dots would be a line
  const auto stations =
      std::count_if(line.begin(), line.end(), [](const ProfilePoint& p) { return p.is_station; });
  const double width = at(line.back().distance, 0).x - area_.left;
  if (stations < 2 || width / static_cast<double>(stations - 1) < kClosest) return;
  for (const ProfilePoint& p : line) {
    if (p.is_station && std::isfinite(p.height)) {
      canvas_.dot(at(p.distance, p.height), kStationRadius, kInk);
    }
  }
}

void Panel::draw_axes() {
  constexpr Stroke kFine{kGrid, 1.0, 0.6};
  constexpr double kTick = 5;
  const ShownUnit& lengths = scales_.lengths;
  const Ticks across = round_ticks(0, scales_.length / lengths.size, 11);
  for (const double tick : across.at) {
    const double x = at(tick * lengths.size, 0).x;
    canvas_.line({x, area_.top}, {x, area_.bottom}, kFine);
    canvas_.line({x, area_.bottom}, {x, area_.bottom + kTick}, {});
    canvas_.text({x, area_.bottom + 15}, tick_text(tick, across.step), {TextAnchor::kMiddle});
  }
  const Ticks up = round_ticks(scales_.low, scales_.high, 7);
  for (const double tick : up.at) {
    const double y = at(0, tick).y;
    canvas_.line({area_.left, y}, {area_.right, y}, kFine);
    canvas_.line({area_.left - kTick, y}, {area_.left, y}, {});
    canvas_.text({area_.left - 9, y}, tick_text(tick, up.step), {TextAnchor::kEnd});
  }
  const CanvasBox& a = area_;
  canvas_.line(std::array<CanvasPoint, 5>{{{a.left, a.top},
                                           {a.right, a.top},
                                           {a.right, a.bottom},
                                           {a.left, a.bottom},
                                           {a.left, a.top}}},
               {});
  canvas_.text({(a.left + a.right) / 2, a.bottom + 34}, lengths.title(scales_.across),
               {TextAnchor::kMiddle});
  canvas_.text({18, (a.top + a.bottom) / 2}, scales_.heights.title(scales_.up),
               {.anchor = TextAnchor::kMiddle, .turn = kReadFromBelow});
}

void Panel::draw_note(const std::string& text) {
  draw_words({(area_.left + area_.right) / 2, (area_.top + area_.bottom) / 2}, text);
}

void Panel::draw_words(CanvasPoint middle, const std::string& text) {
  const double half = canvas_.text_width(text) / 2 + 6;
  canvas_.box({middle.x - half, middle.y - 10, middle.x + half, middle.y + 10}, {255, 255, 255});
  canvas_.text(middle, text, {TextAnchor::kMiddle});
}

}  // namespace ptin::tools
