// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/plot/profile_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ptin::tools {

namespace {

/// The lowest and the highest of heights; infinite, and the lowest above the highest, for none.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  void add(std::span<const ProfilePoint> points) {
    for (const ProfilePoint& p : points) {
      if (!std::isfinite(p.height)) continue;
      low = std::min(low, p.height);
      high = std::max(high, p.height);
    }
  }
};

std::string facts_of(std::span<const ProfilePoint> line, const PanelScales& scales) {
  std::string facts = "length " + scales.lengths.text(line.back().distance);
  Range heights;
  heights.add(line);
  if (heights.low > heights.high) return facts;
  return facts + ", heights " + scales.heights.text(heights.low) + " to " +
         scales.heights.text(heights.high);
}

bool has(const ProfileResult& profile, PointState state) {
  return std::any_of(profile.points.begin(), profile.points.end(),
                     [&](const ProfilePoint& p) { return p.state == state; });
}

std::vector<LegendEntry> legend_of(const ProfileResult& profile, const PanelScales& scales,
                                   const PlotUnits& units) {
  std::vector<LegendEntry> entries;
  const bool has_ground = has(profile, PointState::kSurface);
  if (has_ground && profile.certified_deviation > 0 && std::isfinite(profile.certified_deviation)) {
    entries.push_back(deviation_entry(profile.certified_deviation, scales.heights));
  }
  if (std::any_of(profile.points.begin(), profile.points.end(),
                  [](const ProfilePoint& p) { return p.is_station; })) {
    entries.push_back(station_entry());
  }
  if (has(profile, PointState::kVoid)) entries.push_back(void_entry());
  if (has_ground) entries.push_back({nullptr, exaggeration_text(scales, units)});
  return entries;
}

}  // namespace

void plot_profile(const std::string& path, bool overwrite, const ProfileResult& profile,
                  const std::vector<std::string>& ids, const PlotUnits& units) {
  const auto lines = lines_of(profile);
  require_panels(lines.size(), "lines", path);
  double longest = 0.0;
  for (const auto& line : lines) longest = std::max(longest, line.back().distance);
  Range heights;
  heights.add(profile.points);
  const double off = std::isfinite(profile.certified_deviation) ? profile.certified_deviation : 0.0;
  const PanelScales scales(units, longest, heights.low - off, heights.high + off);
  Canvas canvas = sheet_for(lines.size(), path, overwrite);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::uint32_t number = lines[i].front().line;
    Panel panel(canvas, i, scales);
    panel.draw_title(ids.empty() ? "line " + std::to_string(number + 1) : ids[number],
                     facts_of(lines[i], scales));
    panel.draw_ground(lines[i], off);
    panel.draw_axes();
    panel.draw_stations(lines[i]);
    Range own;
    own.add(lines[i]);
    if (own.low > own.high) panel.draw_note("no ground below the line");
  }
  draw_sheet_legend(canvas, legend_of(profile, scales, units));
  canvas.publish();
}

}  // namespace ptin::tools
