// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/volume_plot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "tools/facts/human.h"

namespace ptin::tools {

namespace {

constexpr Colour kFillColour{20, 100, 190}, kCutColour{118, 70, 34}, kUnsure{222, 130, 40};
constexpr double kUnsureOpacity = 0.35;
constexpr double kLevelRadius = 2.4, kClosestLevels = 5.0;  // pixels

/// An amount at a level, and what it is for certain.
struct AmountAt {
  double level, value, low, high;
};

/// A panel: an amount over levels.
struct AmountCurve {
  std::string title;
  std::string axis;
  const char* power;  ///< Power of lengths: "²" or "³".
  Colour colour;
  std::vector<AmountAt> amounts;  ///< By rising levels.

  [[nodiscard]] double most() const {
    double most = 0.0;
    for (const AmountAt& a : amounts) most = std::max(most, a.high);
    return most;
  }
};

/// Amounts in thousands, millions or billions, so that ticks have few digits.
ShownUnit shown_amount(const std::string& length_unit, const char* power, double most) {
  const std::string name = short_unit(length_unit);
  const std::string unit = name.empty() ? name : name + power;
  for (const auto& [size, word] :
       {std::pair{1e9, "billion"}, {1e6, "million"}, {1e3, "thousand"}}) {
    if (most >= 10 * size) return {size, name.empty() ? word : word + (" " + unit)};
  }
  return {1.0, unit};
}

std::vector<AmountCurve> curves_of(std::span<const VolumeResult> results,
                                   std::span<const double> levels) {
  std::vector<std::size_t> order(levels.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return levels[a] < levels[b]; });
  AmountCurve below{"below the level (fill)", "volume", "³", kFillColour, {}};
  AmountCurve area{"area below the level", "area", "²", kFillColour, {}};
  AmountCurve above{"above the level (cut)", "volume", "³", kCutColour, {}};
  for (const std::size_t i : order) {
    const VolumeResult& r = results[i];
    below.amounts.push_back({levels[i], r.fill.value, r.fill.low, r.fill.high});
    area.amounts.push_back({levels[i], r.fill_area, r.fill_area, r.fill_area});
    above.amounts.push_back({levels[i], r.cut.value, r.cut.low, r.cut.high});
  }
  return {std::move(below), std::move(area), std::move(above)};
}

void draw_curve(Canvas& canvas, std::size_t number, const AmountCurve& curve,
                const PlotUnits& units, bool has_band) {
  const std::vector<AmountAt>& amounts = curve.amounts;
  const double most = curve.most();
  // Amounts are no lengths: heights are not compared with them.
  PanelScales scales({units.length, units.height, 0.0}, most, amounts.front().level,
                     amounts.back().level);
  scales.lengths = shown_amount(units.length, curve.power, scales.length);
  scales.across = curve.axis;
  scales.up = "level";
  Panel panel(canvas, number, scales);
  const auto amount_at = [&](const AmountAt& a) {
    return shown_amount(units.length, curve.power, a.value).text(a.value) + " at " +
           scales.heights.text(a.level);
  };
  panel.draw_title(curve.title, amount_at(amounts.front()) + ", " + amount_at(amounts.back()));
  std::vector<CanvasPoint> line, band;
  for (const AmountAt& a : amounts) {
    line.push_back(panel.at(a.value, a.level));
    band.push_back(panel.at(a.low, a.level));
  }
  for (auto a = amounts.rbegin(); a != amounts.rend(); ++a) {
    band.push_back(panel.at(a->high, a->level));
  }
  canvas.clip(panel.area());
  if (has_band) canvas.polygon(band, kUnsure, kUnsureOpacity);
  canvas.line(line, {curve.colour, 1.8});
  const double apart = std::abs(line.front().y - line.back().y) /
                       std::max(static_cast<double>(line.size()) - 1, 1.0);
  if (line.size() == 1 || apart >= kClosestLevels) {
    for (const CanvasPoint& p : line) canvas.dot(p, kLevelRadius, curve.colour);
  }
  canvas.unclip();
  panel.draw_axes();
}

}  // namespace

void plot_volumes(const std::string& path, bool overwrite, std::span<const VolumeResult> results,
                  std::span<const double> levels, const PlotUnits& units) {
  const std::vector<AmountCurve> curves = curves_of(results, levels);
  const bool has_band =
      std::any_of(results.begin(), results.end(), [](const VolumeResult& r) { return !r.exact; });
  Canvas canvas = sheet_for(curves.size(), path, overwrite);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    draw_curve(canvas, i, curves[i], units, has_band && curves[i].axis == "volume");
  }
  std::vector<LegendEntry> legend = {{nullptr, counted(levels.size(), "level")}};
  if (has_band) {
    legend.push_back({[](Canvas& c, const CanvasBox& box) { c.box(box, kUnsure, kUnsureOpacity); },
                      "where the source's volume certainly lies"});
  }
  draw_sheet_legend(canvas, legend);
  canvas.publish();
}

}  // namespace ptin::tools
