// SPDX-License-Identifier: GPL-3.0-or-later
//
// A panel: the ground along one line, over an axis of distances and beside one of heights.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/query/questions.h"
#include "tools/plot/axis.h"
#include "tools/plot/canvas.h"

namespace ptin::tools {

/// The units of what is plotted.
struct PlotUnits {
  std::string length;  ///< Names, as CrsFacts has them.
  std::string height;
  double heights_per_length = 1.0;  ///< Units of heights in a unit of length.
};

/// What the panels of a picture have in common.
struct PanelScales {
  double length = 1.0;  ///< At the right end of the axis of distances; > 0.
  double low = 0.0;     ///< Lower end of the axis of heights; below `high`.
  double high = 1.0;
  ShownUnit lengths, heights;
  std::string across = "distance", up = "height";  ///< What the axes are of.

  /// Scales for lines of at most this length, and heights of any number.
  /// @param low, high  Infinite (low above high): there is no ground.
  PanelScales(const PlotUnits& units, double longest, double low, double high);
};

/// How many panels a picture may have; their height, and with it the file, grows with them.
constexpr std::size_t kMostPanels = 12;
/// @param things  What has a panel each, as "lines".
/// @throws Error invalid_argument  more than kMostPanels
void require_panels(std::size_t count, const std::string& things, const std::string& path);

/// A sign of the legend: what is drawn into a small box, and what it means.
struct LegendEntry {
  std::function<void(Canvas&, const CanvasBox&)> draw;  ///< None: the words alone.
  std::string text;
};
[[nodiscard]] LegendEntry line_entry(const Stroke& stroke, std::string text);
[[nodiscard]] LegendEntry void_entry();
[[nodiscard]] LegendEntry station_entry();
/// The entry of the band that a certificate gives.
[[nodiscard]] LegendEntry deviation_entry(double deviation, const ShownUnit& heights);
/// How much steeper slopes look than they are: "heights 12 times exaggerated", or "0.5 of their true
/// scale".
[[nodiscard]] std::string exaggeration_text(const PanelScales& scales, const PlotUnits& units);

/// A sheet for so many panels, one below the other, and the legend below them.
[[nodiscard]] Canvas sheet_for(std::size_t panels, const std::string& path, bool overwrite);
void draw_sheet_legend(Canvas& canvas, std::span<const LegendEntry> entries);

class Panel {
 public:
  /// @param number  From 0, from above.
  Panel(Canvas& canvas, std::size_t number, const PanelScales& scales);

  [[nodiscard]] CanvasPoint at(double distance, double height) const;
  [[nodiscard]] const CanvasBox& area() const noexcept { return area_; }

  void draw_title(const std::string& title, const std::string& facts);
  /// The ground filled, voids hatched, what is outside of the terrain left blank; and the band that
  /// the ground certainly lies in. Points closer than the pixels are drawn as their lowest and
  /// highest.
  void draw_ground(std::span<const ProfilePoint> line, double deviation);
  /// The frame, ticks and units, and a grid over what is there.
  void draw_axes();
  /// A dot at every station that stands on ground, unless they would touch.
  void draw_stations(std::span<const ProfilePoint> line);
  /// Words in the middle.
  void draw_note(const std::string& text);

 private:
  void draw_surface(std::span<const ProfilePoint> stretch, double deviation);
  void draw_void(const CanvasBox& band);
  /// On white.
  void draw_words(CanvasPoint middle, const std::string& text);

  Canvas& canvas_;
  const PanelScales& scales_;
  CanvasBox area_;
};

}  // namespace ptin::tools
