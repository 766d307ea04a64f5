// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/sight_plot.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tools/facts/answers.h"
#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr Colour kVisible{24, 132, 66}, kHidden{200, 30, 40}, kUndecided{120, 100, 0};
constexpr Colour kZone{60, 120, 210};
constexpr int kSteps = 400;         // of a curved line
constexpr double kFreeShare = 0.6;  // of the first Fresnel zone

const Colour& colour_of(const SightResult& result) {
  if (result.verdict == SightVerdict::kVisible) return kVisible;
  return result.verdict == SightVerdict::kHidden ? kHidden : kUndecided;
}

class SightPanel {
 public:
  SightPanel(const PlottedSight& sight, const SightPlotStyle& style, const PlotUnits& units)
      : sight_(sight),
        style_(style),
        units_(units),
        has_line_(std::isfinite(sight.a.height) && std::isfinite(sight.b.height) && length() > 0),
        scales_(make_scales()) {}

  void draw(Canvas& canvas, std::size_t number) const {
    Panel panel(canvas, number, scales_);
    panel.draw_title(sight_.title, facts());
    if (!sight_.profile.points.empty()) {
      const double deviation = sight_.profile.certified_deviation;
      panel.draw_ground(sight_.profile.points, std::isfinite(deviation) ? deviation : 0.0);
    }
    panel.draw_axes();
    if (has_line_) {
      draw_zone(canvas, panel);
      draw_line(canvas, panel);
    } else {
      panel.draw_note(length() > 0 ? "an end stands on no ground" : "both ends are at one place");
    }
  }

 private:
  [[nodiscard]] double length() const { return sight_.result.length; }
  [[nodiscard]] double height(double share) const {
    return sight_height(sight_, style_.curvature, share);
  }
  /// The radius of the first Fresnel zone.
  [[nodiscard]] double radius(double share) const {
    return std::sqrt(style_.wavelength * length() * share * (1 - share));
  }

  [[nodiscard]] PanelScales make_scales() const {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    const auto add = [&](double value) {
      if (!std::isfinite(value)) return;
      low = std::min(low, value);
      high = std::max(high, value);
    };
    for (const ProfilePoint& p : sight_.profile.points) {
      add(p.height - sight_.profile.certified_deviation);
      add(p.height + sight_.profile.certified_deviation);
    }
    for (int i = 0; has_line_ && i <= kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      add(height(share) - radius(share));
      add(height(share) + radius(share));
    }
    return {units_, length(), low, high};
  }

  /// The curve that lies so many radii of the Fresnel zone above the line.
  [[nodiscard]] std::vector<CanvasPoint> curve(const Panel& panel, double radii) const {
    std::vector<CanvasPoint> points;
    for (int i = 0; i <= kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      points.push_back(panel.at(share * length(), height(share) + radii * radius(share)));
    }
    return points;
  }

  void draw_zone(Canvas& canvas, const Panel& panel) const {
    if (!(style_.wavelength > 0)) return;
    std::vector<CanvasPoint> zone = curve(panel, 1);
    const std::vector<CanvasPoint> lower = curve(panel, -1);
    canvas.line(zone, {kZone, 1.0, 0.7});
    canvas.line(lower, {kZone, 1.0, 0.7});
    zone.insert(zone.end(), lower.rbegin(), lower.rend());
    canvas.polygon(zone, kZone, 0.16);
    for (const double radii : {kFreeShare, -kFreeShare}) {
      canvas.line(curve(panel, radii), {kZone, 1.0, 0.8, true});
    }
  }

  void draw_line(Canvas& canvas, const Panel& panel) const {
    canvas.line(curve(panel, 0), {colour_of(sight_.result), 1.8});
    draw_end(canvas, panel, 0.0);
    draw_end(canvas, panel, 1.0);
    const SightResult& r = sight_.result;
    if (r.clearance_at && std::isfinite(r.clearance_min)) {
      const SightPoint& p = *r.clearance_at;
      const double ground = p.height - r.clearance_min;
      canvas.line(panel.at(p.distance, ground), panel.at(p.distance, p.height), {kInk, 1.4});
      canvas.dot(panel.at(p.distance, ground), 2.6, kInk);
      draw_clearance_label(canvas, panel, p.distance,
                           {std::min(ground, p.height), std::max(ground, p.height)});
    }
    if (r.obstruction) {
      canvas.dot(panel.at(r.obstruction->distance, r.obstruction->height), 4.0, kHidden);
    }
  }

  /// Above the heights of the line and of the ground, or below them where the label of an end is.
  void draw_clearance_label(Canvas& canvas, const Panel& panel, double distance,
                            std::pair<double, double> heights) const {
    constexpr double kEndLabel = 170, kLower = 28;  // pixels of the corners that ends' labels take
    const CanvasBox& area = panel.area();
    const CanvasPoint top = panel.at(distance, heights.second);
    const bool is_left = top.x < (area.left + area.right) / 2;
    const double beside = is_left ? top.x - area.left : area.right - top.x;
    const bool is_taken = beside < kEndLabel && top.y - 12 < area.top + kLower;
    const double y = is_taken ? std::max(panel.at(distance, heights.first).y, area.top) + kLower
                              : std::max(top.y - 12, area.top + 10);
    label(canvas, {top.x + (is_left ? 9 : -9), y}, is_left ? TextAnchor::kBegin : TextAnchor::kEnd,
          clearance_text());
  }

  /// What carries an end, from the ground up.
  void draw_end(Canvas& canvas, const Panel& panel, double share) const {
    const PlottedSight::End& end = share == 0 ? sight_.a : sight_.b;
    const auto& points = sight_.profile.points;
    const double ground = share == 0 ? points.front().height : points.back().height;
    const CanvasPoint top = panel.at(share * length(), end.height);
    if (std::isfinite(ground)) {
      canvas.line(panel.at(share * length(), ground), top, {kInk, 3.0});
    }
    canvas.dot(top, 3.5, kInk);
    // In the corner of the panel above it, where the line seldom runs.
    const CanvasBox& area = panel.area();
    share == 0 ? label(canvas, {area.left + 8, area.top + 13}, TextAnchor::kBegin, end.label)
               : label(canvas, {area.right - 8, area.top + 13}, TextAnchor::kEnd, end.label);
  }

  /// Words on a light ground.
  static void label(Canvas& canvas, CanvasPoint at, TextAnchor anchor, const std::string& text) {
    const double other = at.x + (anchor == TextAnchor::kBegin ? 1 : -1) * canvas.text_width(text);
    const auto [left, right] = std::minmax(at.x, other);
    canvas.box({left - 3, at.y - 8, right + 3, at.y + 8}, {255, 255, 255}, 0.75);
    canvas.text(at, text, {anchor});
  }

  /// The least clearance, or what it lies between.
  [[nodiscard]] std::string clearance_text() const {
    const SightResult& r = sight_.result;
    const std::string least = scales_.heights.text(r.clearance_min);
    if (r.clearance_max == r.clearance_min) return least;
    if (!std::isfinite(r.clearance_max)) return least + " or more";
    return least + " to " + scales_.heights.text(r.clearance_max);
  }

  [[nodiscard]] std::string facts() const {
    const SightResult& r = sight_.result;
    std::string facts = name_of(r.verdict);
    if (r.obstruction) facts += " from " + scales_.lengths.text(r.obstruction->distance) + " on";
    if (r.clearance_at && std::isfinite(r.clearance_min)) {
      facts += ", least clearance " + clearance_text() + " at " +
               scales_.lengths.text(r.clearance_at->distance);
    }
    if (r.fresnel_ratio) facts += ", Fresnel ratio " + ShownUnit{}.text(*r.fresnel_ratio);
    if (!has_line_) return facts;
    return facts + "; " + exaggeration_text(scales_, units_);
  }

  const PlottedSight& sight_;
  const SightPlotStyle& style_;
  const PlotUnits& units_;
  bool has_line_;
  PanelScales scales_;
};

std::vector<LegendEntry> legend_of(std::span<const PlottedSight> sights,
                                   const SightPlotStyle& style, const PlotUnits& units) {
  std::vector<LegendEntry> entries;
  double deviation = 0.0;
  bool has_void = false;
  for (const PlottedSight& s : sights) {
    if (std::isfinite(s.profile.certified_deviation))
      deviation = std::max(deviation, s.profile.certified_deviation);
    has_void = has_void || std::any_of(s.profile.points.begin(), s.profile.points.end(),
                                       [](const auto& p) { return p.state == PointState::kVoid; });
  }
  for (const SightVerdict verdict :
       {SightVerdict::kVisible, SightVerdict::kHidden, SightVerdict::kUndecided}) {
    const auto shown = std::find_if(sights.begin(), sights.end(), [&](const PlottedSight& s) {
      return s.result.verdict == verdict;
    });
    if (shown == sights.end()) continue;
    entries.push_back(line_entry({colour_of(shown->result), 1.8},
                                 std::string("line of sight, ") + name_of(verdict)));
  }
  const bool has_lines = !entries.empty();
  if (has_lines && style.curvature.coefficient > 0) {
    entries.push_back({nullptr, "sunk by curvature " + short_number(style.curvature.coefficient)});
  }
  if (has_lines && style.wavelength > 0) {
    entries.push_back(
        {[](Canvas& c, const CanvasBox& box) { c.box(box, kZone, 0.16); }, "first Fresnel zone"});
    entries.push_back(line_entry({kZone, 1.0, 0.8, true}, "0.6 of it"));
  }
  if (deviation > 0) {
    entries.push_back(deviation_entry(deviation, {1.0, short_unit(units.height)}));
  }
  if (has_void) entries.push_back(void_entry());
  return entries;
}

}  // namespace

double sight_height(const PlottedSight& sight, const Curvature& curvature, double share) {
  const double length = sight.result.length;
  const double sunk =
      curvature.coefficient * share * length * (1 - share) * length / curvature.earth_diameter;
  return std::lerp(sight.a.height, sight.b.height, share) - sunk;
}

void plot_sights(const std::string& path, bool overwrite, std::span<const PlottedSight> sights,
                 const SightPlotStyle& style, const PlotUnits& units) {
  require_panels(sights.size(), "pairs", path);
  Canvas canvas = sheet_for(sights.size(), path, overwrite);
  for (std::size_t i = 0; i < sights.size(); ++i)
    SightPanel(sights[i], style, units).draw(canvas, i);
  draw_sheet_legend(canvas, legend_of(sights, style, units));
  canvas.publish();
}

}  // namespace ptin::tools
